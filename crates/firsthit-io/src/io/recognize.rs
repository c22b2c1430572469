//! The real format of a file with another's name, or of one that is not read, and how to make one
//! that is.

use std::path::Path;

use super::fault::Fault;
use super::format::Format;
use super::formats::FORMATS;
use super::source::has_extension;

/// Formats that are not read, and what makes one of them that is.
const WAYS: &[(&[&str], &str)] = &[
    (
        &["step", "stp", "iges", "igs", "brep", "brp", "fcstd", "ifc"],
        "FreeCAD opens {} and exports .stl, .obj or .glb",
    ),
    (
        &["usd", "usda", "usdc", "usdz"],
        "Blender opens {} and exports .glb; usdcat shows what is in it",
    ),
    (
        &["3mf", "dae", "amf", "xaml", "3dxml", "ctm"],
        "trimesh reads {}: trimesh.load(FILE).export(\"part.glb\")",
    ),
    (
        &["3ds", "fbx", "blend", "x3d", "wrl", "vrml", "abc", "lwo"],
        "Blender opens {} and exports .glb",
    ),
    (
        &["vtk", "vtp", "vtu", "msh", "mesh", "inp", "xdmf"],
        "meshio reads {}: meshio convert FILE part.ply",
    ),
    (
        &["sldprt", "sldasm", "ipt", "iam", "prt", "catpart", "x_t", "sat"],
        "the CAD program that made it exports .stl, or .step for FreeCAD",
    ),
    (
        &["las", "laz", "pcd", "xyz", "e57", "pts", "asc"],
        "{} holds points without a surface: MeshLab and Open3D make a mesh of them",
    ),
];

/// The beginnings of files, and the extension of each kind.
const BEGINNINGS: &[(&[u8], &str)] = &[
    (b"glTF", "glb"),
    (b"ply\n", "ply"),
    (b"ply\r", "ply"),
    (b"OFF", "off"),
    (b"COFF", "off"),
    (b"NOFF", "off"),
    (b"STOFF", "off"),
    (b"solid ", "stl"),
    (b"ISO-10303-21", "step"),
    (b"Kaydara FBX Binary", "fbx"),
    (b"PXR-USDC", "usdc"),
    (b"#usda", "usda"),
    (b"BLENDER", "blend"),
    (b"# vtk", "vtk"),
    (b"LASF", "las"),
    (b"# .PCD", "pcd"),
    (b"$MeshFormat", "msh"),
    (b"#VRML", "wrl"),
];

/// The way from a file that is not read to one that is, by its extension.
pub(super) fn way_of(path: &Path) -> Option<String> {
    WAYS.iter().find_map(|(extensions, way)| {
        let is_it = |extension: &&&str| has_extension(path, &[extension]);
        let extension = extensions.iter().find(is_it)?;
        Some(way.replace("{}", &format!(".{extension}")))
    })
}

/// The reason why content is not of `format`, with what it is of by its first bytes, if that is
/// something else.
pub(super) fn hinted(fault: Fault, format: &Format, bytes: &[u8]) -> Fault {
    let Fault::Content { place, what } = fault else {
        return fault;
    };
    let mut beginnings = BEGINNINGS.iter();
    let found = beginnings.find(|(beginning, _)| bytes.starts_with(beginning));
    let hint = found.and_then(|&(_, extension)| {
        if format.extensions.contains(&extension) {
            return None;
        }
        let mut models = FORMATS.iter().map(|model| &model.format);
        if let Some(other) = models.find(|other| other.extensions.contains(&extension)) {
            let name = other.name;
            return Some(format!("by its content this is {name}: name it .{extension}"));
        }
        let way = way_of(Path::new(&format!("x.{extension}")))?;
        Some(format!("by its content this is .{extension}: {way}"))
    });
    match hint {
        Some(hint) => Fault::at(place, format!("{what}; {hint}")),
        None => Fault::Content { place, what },
    }
}
