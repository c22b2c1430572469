//! Skins at rest: where the joints are, and what they do to a vertex.

use super::super::fault::Checked;
use super::super::report::Report;
use super::accessor::{Elements, Shape, component};
use super::buffers::Buffers;
use super::document::Document;
use super::index::Index;
use super::nodes::Placed;
use super::place::Entry;
use super::values::Values;
use crate::geometry::DAffine3;

/// The maps of the joints, each from the mesh as it was bound to the world.
pub(super) type Palette = Vec<DAffine3>;

/// The transform of each node, by its index; `None` for those that are not part of the scene.
pub(super) fn worlds(document: &Document<'_>, placed: &[Placed<'_>]) -> Vec<Option<DAffine3>> {
    let mut worlds = vec![None; document.nodes.len()];
    for place in placed {
        if let Some(world) = worlds.get_mut(place.index) {
            *world = Some(place.world_from_node);
        }
    }
    worlds
}

/// The palette of a skin, from where the nodes are.
pub(super) fn palette<'a>(
    document: &'a Document<'a>,
    Index(skin): Index,
    worlds: &[Option<DAffine3>],
    buffers: &mut Buffers<'a>,
    report: &mut Report,
) -> Checked<Palette> {
    let entry = Entry::new("skins", skin);
    let skin = document.skins.get(skin);
    let skin = skin.ok_or_else(|| entry.fault("", "there is no such skin"))?;
    let bind = skin.inverse_bind_matrices.map(|index| {
        let elements = Elements::new(document, index, &Shape::MAT4, buffers, report)?;
        elements.read::<f64, 16>(report)
    });
    let bind = bind.transpose()?;
    if let Some(bind) = &bind
        && bind.len() < skin.joints.len()
    {
        let (matrices, joints) = (bind.len(), skin.joints.len());
        let what = format!("has {matrices} matrices for {joints} joints");
        return Err(entry.fault("inverseBindMatrices", what));
    }
    let room = (skin.joints.len() as u64).saturating_mul(size_of::<DAffine3>() as u64);
    report.budget.charge(room, "the joints")?;
    let joints = skin.joints.iter().enumerate().map(|(k, &Index(joint))| {
        let world = worlds.get(joint).copied().flatten().unwrap_or_else(|| {
            report.warn("joint", &entry.at(format!("joints/{k}")), || {
                format!("node {joint} is not part of the scene, and taken to be at the origin")
            });
            DAffine3::IDENTITY
        });
        let bind = bind.as_ref().and_then(|bind| bind.get(k));
        bind.map_or(world, |bind| world * affine(bind))
    });
    Ok(joints.collect())
}

/// The first three rows of a matrix, given column by column.
fn affine(&[a, b, c, _, d, e, f, _, g, h, i, _, x, y, z, _]: &[f64; 16]) -> DAffine3 {
    DAffine3::from_cols_array(&[a, b, c, d, e, f, g, h, i, x, y, z])
}

/// The map of each vertex of a primitive, from where it was bound to the world.
pub(super) fn maps(
    values: &mut Values<'_, '_, '_>,
    palette: &Palette,
    world_from_node: DAffine3,
    vertices: usize,
) -> Checked<Vec<DAffine3>> {
    let room = (vertices as u64).saturating_mul(size_of::<DAffine3>() as u64);
    values.report.budget.charge(room, "a skin")?;
    let mut maps = vec![DAffine3::ZERO; vertices];
    let mut sums = vec![0.0; vertices];
    for set in 0_usize.. {
        let (joints, weights) = (format!("JOINTS_{set}"), format!("WEIGHTS_{set}"));
        let Some(index) = values.attribute(&joints) else {
            break;
        };
        if !component(values.document, index)?.is_unsigned() {
            return Err(values.attribute_fault(&joints, "must be unsigned"));
        }
        let indices = values.read::<u32, 4>(&joints, &Shape::VEC4, vertices)?.unwrap_or_default();
        let Some(shares) = values.read::<f64, 4>(&weights, &Shape::VEC4, vertices)? else {
            return Err(values.attribute_fault(&weights, "is missing"));
        };
        let places = maps.iter_mut().zip(&mut sums);
        for ((map, sum), (indices, shares)) in places.zip(indices.iter().zip(&shares)) {
            for (&joint, &share) in indices.iter().zip(shares) {
                // Joints without a share may be anything.
                if share == 0.0 {
                    continue;
                }
                let Some(joint_map) = palette.get(joint as usize) else {
                    let what = format!("joint {joint} of a skin of {}", palette.len());
                    return Err(values.attribute_fault(&joints, what));
                };
                *sum += share;
                map.matrix3 += share * joint_map.matrix3;
                map.translation += share * joint_map.translation;
            }
        }
    }
    even_out(values, &mut maps, &sums);
    put_back(values, &mut maps, &sums, world_from_node);
    Ok(maps)
}

/// Leaves vertices that no joint moves where the mesh's node puts them: as a sum of nothing they
/// would all fall into the origin.
fn put_back(
    values: &mut Values<'_, '_, '_>,
    maps: &mut [DAffine3],
    sums: &[f64],
    world_from_node: DAffine3,
) {
    let is_moved = |&sum: &f64| sum > 0.0;
    let Some(first) = sums.iter().position(|sum| !is_moved(sum)) else {
        return;
    };
    let count = sums.iter().filter(|sum| !is_moved(sum)).count();
    let place = values.place("attributes/WEIGHTS_0");
    values.report.warn("no weights", &place, || {
        format!(
            "vertices without a weight: {count}, the first at index {first}; \
             they stay where the node is"
        )
    });
    for (map, _) in maps.iter_mut().zip(sums).filter(|(_, sum)| !is_moved(sum)) {
        *map = world_from_node;
    }
}

/// Divides by the shares' sum where it is not one, as it must be; only where it is off by more than
/// rounding, so that vertices that are right do not move.
fn even_out(values: &mut Values<'_, '_, '_>, maps: &mut [DAffine3], sums: &[f64]) {
    let is_off = |sum: f64| sum > 0.0 && (sum - 1.0).abs() > 0.01;
    let mut wrong = sums.iter().filter(|&&sum| is_off(sum));
    let Some(first) = wrong.next() else { return };
    let place = values.place("attributes");
    values.report.warn("weights", &place, || {
        let count = wrong.count() + 1;
        format!("the weights of {count} vertices are divided by their sum, such as {first}: it must be 1")
    });
    for (map, &sum) in maps.iter_mut().zip(sums).filter(|&(_, &sum)| is_off(sum)) {
        map.matrix3 *= 1.0 / sum;
        map.translation /= sum;
    }
}
