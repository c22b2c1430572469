//! Takes a scene apart, and writes its sections.

use std::io::{self, Write};
use std::path::Path;

use super::layout::{
    BEFORE_DIGEST, Element, MAGIC, SectionKind, Sum, UNIT, VERSION, sum_of_structure,
};
use super::look::{KindRecord, ShadingRecord, direction_of};
use super::number::{Number, Triple};
use super::record::{
    AttributeRecord, GroupRecord, MeshRecord, PositionsRecord, PropertyRecord, Record, Section,
    TextureRecord, TreeRecord, ValuesRecord,
};
use super::sensor::CameraRecord;
use super::tables::Tables;
use crate::accel::MeshTree;
use crate::error::{Error, Result, escaped};
use crate::geometry::{Bounds, DVec3};
use crate::image::write_whole;
use crate::memory;
use crate::parallel;
use crate::scene::Scene;
use crate::shape::{Attribute, Between, Mesh, Positions, Property, PropertyOf, PropertyValues};
use crate::watch::{Watch, stop_if_asked};
use crate::world::World;

/// Writes a built scene to a `.fhs` file, which [`open`](super::open) maps: its trees are not built
/// again.
///
/// The file appears whole or not at all, as all outputs do; a file of that name is replaced, and
/// those who have it open keep theirs. `world` says what the scene itself does not: cameras,
/// lights, the background, how to shade, which way is up. Its objects are not asked, since they are
/// the scene's, and outputs stay behind. Control characters in names are escaped when the file is
/// opened.
///
/// Equal scenes give equal bytes on every machine.
///
/// # Errors
///
/// [`Error::Argument`] for lights, a background or an up direction that point nowhere, and for
/// samples that are not from 1 to 65,536; [`Error::Write`] when the system refuses,
/// [`Error::Limit`] where memory is short, and [`Error::Interrupted`] when `watch` stops it.
pub fn save(path: &Path, scene: &Scene, world: &World, watch: &dyn Watch) -> Result<()> {
    with_content(path, scene, world, watch, |content| {
        write_whole(path, watch, |out| content.write(out, watch))
    })
}

/// The content of the file that [`save`] would write. [`load_bytes`](crate::load::load_bytes) reads
/// it.
///
/// # Errors
///
/// The errors of [`save`].
pub fn encode(scene: &Scene, world: &World, watch: &dyn Watch) -> Result<Vec<u8>> {
    let path = Path::new("the scene");
    with_content(path, scene, world, watch, |content| {
        memory::check("a built scene's content", content.bytes())?;
        let mut bytes = memory::room(content.bytes());
        let written = content.write(&mut bytes, watch);
        written.map_err(|source| refused(path, source))?;
        Ok(bytes)
    })
}

/// The content of a file.
struct Content<'a> {
    header: [u8; UNIT],
    table: Vec<u8>,
    sections: Vec<SectionBytes<'a>>,
}

impl Content<'_> {
    /// The length in bytes.
    fn bytes(&self) -> usize {
        let sections = self.sections.iter();
        let sections = sections.map(|(_, bytes)| bytes.len().next_multiple_of(UNIT));
        UNIT + self.table.len() + sections.sum::<usize>()
    }

    fn write(&self, out: &mut dyn Write, watch: &dyn Watch) -> io::Result<()> {
        out.write_all(&self.header)?;
        out.write_all(&self.table)?;
        for (_, bytes) in &self.sections {
            for piece in bytes.chunks(PIECE) {
                out.write_all(piece)?;
                watch.advance(piece.len() as u64);
            }
            let padding = bytes.len().next_multiple_of(UNIT) - bytes.len();
            out.write_all([0; UNIT].get(..padding).unwrap_or_default())?;
        }
        Ok(())
    }
}

/// Arrays of numbers that a scene holds in other forms.
struct Lists {
    boxes: Vec<[f64; 6]>,
    duplicates: Vec<[u32; 2]>,
    /// The objects of each group.
    members: Vec<Vec<u32>>,
}

impl Lists {
    fn new(scene: &Scene) -> Self {
        let boxes = scene.boxes().into_iter();
        let numbers = |Bounds { low, high }| [low.x, low.y, low.z, high.x, high.y, high.z];
        let groups = scene.groups();
        Self {
            boxes: boxes.map(numbers).collect(),
            duplicates: scene.duplicates().pairs(),
            members: groups
                .map(|group| group.members().map(|(object, _)| object).collect())
                .collect(),
        }
    }
}

/// Takes a scene apart for a file at `path`, and hands on what stands in it.
fn with_content<T>(
    path: &Path,
    scene: &Scene,
    world: &World,
    watch: &dyn Watch,
    then: impl FnOnce(&Content<'_>) -> Result<T>,
) -> Result<T> {
    if cfg!(target_endian = "big") {
        let source = io::Error::other("built scenes are not written on big-endian machines");
        return Err(refused(path, source));
    }
    check(world)?;
    // Who opens the file may shoot any number of rays.
    let better;
    let scene = if scene.has_poor_trees() {
        better = scene.with_best_trees(watch)?;
        &better
    } else {
        scene
    };
    let records = scene.objects().len().saturating_mul(RECORD_BYTES);
    memory::check("the description of the scene's objects", records)?;
    let lists = Lists::new(scene);
    let mut parts = Parts::default();
    let record = record(scene, world, &lists, &mut parts);
    let record = serde_json::to_vec(&record).map_err(|source| refused(path, source.into()))?;
    let sections = parts.sections(&record);
    let lengths = sections.iter().map(|(_, bytes)| bytes.len() as u64);
    let (bytes, path) = (lengths.sum(), escaped(path));
    watch.begin(&format!("computing checksums of {path}"), bytes, "bytes");
    let sums = sums(&sections, watch)?;
    let (header, table) = header_and_table(&sections, &sums, &record);
    let content = Content { header, table, sections };
    watch.begin(&format!("writing {path}"), bytes, "bytes");
    then(&content)
}

fn refused(path: &Path, source: io::Error) -> Error {
    let path = path.to_owned();
    Error::Write { path, source }
}

/// Refuses what a reader would.
fn check(world: &World) -> Result<()> {
    for light in &world.lights {
        KindRecord::of_light(light).light()?;
    }
    if let Some(environment) = &world.environment {
        environment.check()?;
    }
    // No section is made yet, so none is named.
    let shading = ShadingRecord::new(world, |_| 0);
    shading.appearance()?;
    shading.display()?;
    shading.edges()?;
    if world.up != DVec3::ZERO {
        direction_of(world.up.into())?;
    }
    Ok(())
}

/// The approximate memory for describing an object.
const RECORD_BYTES: usize = 2048;

/// A section: what it is an array of, and its bytes.
type SectionBytes<'a> = (SectionKind, &'a [u8]);

/// The number of bytes that are hashed between two looks at the watch.
const PIECE: usize = 1 << 24;

/// The checksums of all sections.
fn sums(sections: &[SectionBytes<'_>], watch: &dyn Watch) -> Result<Vec<Sum>> {
    let sum = |(_, bytes): &SectionBytes<'_>| {
        let mut hasher = blake3::Hasher::new();
        for piece in bytes.chunks(PIECE) {
            stop_if_asked(watch)?;
            hasher.update(piece);
            watch.advance(piece.len() as u64);
        }
        Ok(*hasher.finalize().as_bytes())
    };
    parallel::try_map(sections, sum)
}

fn header_and_table(
    sections: &[SectionBytes<'_>],
    sums: &[Sum],
    record: &[u8],
) -> ([u8; UNIT], Vec<u8>) {
    let mut table = Vec::with_capacity(UNIT * sections.len());
    let mut next = UNIT * (sections.len() + 1);
    for ((kind, bytes), sum) in sections.iter().zip(sums) {
        table.extend(kind.code().to_le_bytes());
        table.extend([0; 4]);
        table.extend((next as u64).to_le_bytes());
        table.extend((bytes.len() as u64).to_le_bytes());
        table.extend([0; 8]);
        table.extend(sum);
        next += bytes.len().next_multiple_of(UNIT);
    }
    let mut header = Vec::with_capacity(UNIT);
    header.extend(MAGIC);
    header.extend(VERSION.to_le_bytes());
    header.extend([0; 4]);
    header.extend((next as u64).to_le_bytes());
    header.extend((sections.len() as u64).to_le_bytes());
    debug_assert_eq!(header.len(), BEFORE_DIGEST);
    header.extend(sum_of_structure(&header, &table, record));
    let mut whole = [0; UNIT];
    whole.copy_from_slice(&header);
    (whole, table)
}

/// The sections so far, but for the record, which is the first.
#[derive(Default)]
struct Parts<'a>(Vec<SectionBytes<'a>>);

impl<'a> Parts<'a> {
    fn add<T: Element>(&mut self, values: &'a [T]) -> Section {
        self.0.push((T::KIND, bytemuck::cast_slice(values)));
        self.0.len()
    }

    fn sections<'b>(self, record: &'b [u8]) -> Vec<SectionBytes<'b>>
    where
        'a: 'b,
    {
        let mut sections: Vec<SectionBytes<'b>> = vec![(SectionKind::Record, record)];
        sections.extend(self.0);
        sections
    }

    fn attribute<const N: usize>(
        &mut self,
        attribute: Option<&'a Attribute<N>>,
    ) -> Option<AttributeRecord>
    where
        [f32; N]: Element,
    {
        attribute.map(|attribute| AttributeRecord {
            values: self.add(&attribute.values),
            corners: attribute.corners.as_ref().map(|corners| self.add(corners)),
        })
    }

    fn property(&mut self, property: &'a Property) -> PropertyRecord {
        PropertyRecord {
            name: property.name.clone(),
            of_faces: property.of == PropertyOf::Faces,
            of_corners: property.of == PropertyOf::Corners,
            components: (property.components != 1).then_some(property.components),
            of_nearest: property.between == Between::NearestCorner,
            values: match &property.values {
                PropertyValues::Single(values) => ValuesRecord::Single(self.add(values)),
                PropertyValues::Double(values) => ValuesRecord::Double(self.add(values)),
            },
        }
    }

    fn mesh(&mut self, mesh: &'a Mesh, tree: Option<&'a MeshTree>, positions: usize) -> MeshRecord {
        MeshRecord {
            positions,
            triangles: self.add(mesh.triangles()),
            bounds: corners(mesh.bounds()),
            faces: mesh.faces().map(|faces| self.add(faces)),
            slots: mesh.slots().map(|slots| self.add(slots)),
            normals: self.attribute(mesh.normals()),
            uvs: self.attribute(mesh.uvs()),
            second_uvs: self.attribute(mesh.second_uvs()),
            tangents: self.attribute(mesh.tangents()),
            colors: self.attribute(mesh.colors()),
            alphas: self.attribute(mesh.alphas()),
            properties: mesh.properties().iter().map(|property| self.property(property)).collect(),
            tree: tree.map(|tree| self.tree(tree)),
        }
    }

    fn tree(&mut self, tree: &'a MeshTree) -> TreeRecord {
        let (arrays, facts) = (tree.arrays(), tree.facts());
        TreeRecord {
            nodes: self.add(arrays.nodes),
            leaves: self.add(arrays.leaves),
            order: self.add(arrays.order),
            copies: self.add(arrays.copies),
            exact: facts.is_exact,
            welded: facts.is_welded,
            cost: Number(facts.cost),
        }
    }
}

fn corners(Bounds { low, high }: Bounds) -> [Triple; 2] {
    [low, high].map(Triple::from)
}

fn record<'a>(
    scene: &'a Scene,
    world: &'a World,
    lists: &'a Lists,
    parts: &mut Parts<'a>,
) -> Record {
    let mut tables = Tables::default();
    let mut trees = Vec::new();
    let mut objects = Vec::new();
    for (k, object) in scene.objects().iter().enumerate() {
        objects.push(tables.object(object));
        // The first object with a mesh has its tree, as all have, unless that object shares one.
        if tables.meshes.list.len() > trees.len() {
            trees.push(scene.tree_of(k).own());
        }
    }
    let meshes = tables.meshes.list.iter().zip(trees).map(|(mesh, tree)| {
        let positions = tables.positions.number(mesh.positions());
        parts.mesh(mesh, tree.map(AsRef::as_ref), positions)
    });
    let meshes = meshes.collect();
    let positions = tables.positions.list.iter().map(|positions| match &***positions {
        Positions::Single(points) => PositionsRecord::Single(parts.add(points)),
        Positions::Double(points) => PositionsRecord::Double(parts.add(points)),
    });
    let positions = positions.collect();
    let textures = tables.textures.list.iter().map(|texture| TextureRecord {
        columns: texture.columns(),
        rows: texture.rows(),
        texels: parts.add(texture.texels()),
    });
    let textures = textures.collect();
    let groups = scene.groups().zip(&lists.members).map(|(group, members)| GroupRecord {
        objects: parts.add(members),
        tree: parts.tree(group.tree()),
    });
    let groups = groups.collect();
    let bounds = scene.bounds();
    Record {
        positions,
        meshes,
        textures,
        maps: tables.maps,
        materials: tables.materials,
        labels: tables.labels,
        objects,
        groups,
        boxes: parts.add(&lists.boxes),
        duplicates: parts.add(&lists.duplicates),
        bounds: (!bounds.is_empty()).then(|| corners(bounds)),
        lights: world.lights.iter().map(KindRecord::of_light).collect(),
        cameras: world.cameras.iter().map(CameraRecord::new).collect(),
        shading: ShadingRecord::new(world, |texels| parts.add(texels)),
        has_view: world.has_view,
        up: world.up.into(),
        up_is_guessed: world.up_is_guessed,
    }
}
