//! `OpenEXR`: the first layer that has R, G and B, or else one with luminance alone.

use super::{Picture, charge};
use crate::error::Place;
use crate::image::{Array, ArrayValues, decode_exr};
use crate::io::fault::{Checked, Fault};
use crate::io::memory_budget::size_in_words;
use crate::io::report::Report;

pub(super) fn read(bytes: &[u8], report: &mut Report) -> Checked<Picture> {
    let left = report.budget.left();
    let output = decode_exr(bytes, left).map_err(|what| {
        let left = size_in_words(left);
        Fault::file(format!("{what} ({left} of memory are left of what is allowed)"))
    })?;
    for note in &output.notes {
        report.warn("exr", &Place::File, || note.clone());
    }
    let named = |name: &str, components: usize| {
        let found = output.array(name);
        found.filter(|array| array.components == components)
    };
    let Some(array) = named("color", 3).or_else(|| named("Y", 1)) else {
        let names = output.arrays.iter().filter_map(|array| array.name.clone());
        let names = names.collect::<Vec<_>>().join(", ");
        let what = format!("it has no channels R, G and B, nor a Y alone; there are {names}");
        return Err(Fault::file(what));
    };
    let [rows, columns] = match array.shape[..] {
        [rows, columns] | [rows, columns, _] => [rows, columns],
        _ => [0, 0],
    };
    charge(columns as u64, rows as u64, report)?;
    Ok(Picture { columns, rows, texels: texels(array)? })
}

fn texels(array: &Array) -> Checked<Vec<[f32; 3]>> {
    let ArrayValues::Float32(values) = &array.numbers else {
        return Err(Fault::file("its channels are whole numbers, not light"));
    };
    let mut texels = Vec::new();
    let count = values.len() / array.components.max(1);
    let room = texels.try_reserve_exact(count);
    room.map_err(|_| crate::memory::no_room_for("the texels of an environment"))?;
    texels.extend(values.chunks_exact(array.components.max(1)).map(|values| match *values {
        [red, green, blue] => [red, green, blue],
        [grey] => [grey; 3],
        _ => [0.0; 3],
    }));
    Ok(texels)
}
