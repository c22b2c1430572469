//! Labels of files' nodes and meshes, told apart where a scene file names several files, or one
//! several times.

use std::collections::HashMap;

use crate::io::Report;
use crate::io::fault::Checked;
use crate::scene::Label;

/// Gives labels other numbers, those of each batch beyond all before.
#[derive(Debug, Default)]
pub(super) struct Renumber {
    next: u64,
}

impl Renumber {
    /// The new label of each of a batch; `under` is put before their names, as the path of what
    /// they are parts of.
    pub(super) fn batch<'a>(
        &mut self,
        labels: impl Iterator<Item = &'a Label>,
        under: Option<&str>,
        report: &mut Report,
    ) -> Checked<HashMap<&'a Label, Label>> {
        let first = self.next;
        let mut made: HashMap<&'a Label, Label> = HashMap::new();
        for label in labels {
            if made.contains_key(label) {
                continue;
            }
            let name = match under {
                Some(under) => {
                    let bytes = under.len() + label.name.len() + 1;
                    report.budget.charge(bytes as u64, "a node's path")?;
                    format!("{under}/{}", label.name).into()
                }
                None => label.name.clone(),
            };
            let number = first.saturating_add(label.number);
            self.next = self.next.max(number.saturating_add(1));
            made.insert(label, Label { number, name });
        }
        Ok(made)
    }
}
