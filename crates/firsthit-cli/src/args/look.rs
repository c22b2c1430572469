//! The appearance of a picture: light, colours, and lines along edges.

use clap::Args;
use firsthit::edge::{Dash, EdgeKinds};
use firsthit::geometry::ColorMap;
use firsthit::scene::ColorBy;
use firsthit::{Background, Color};

use crate::environment::{self, EnvironmentArg};
use crate::values::{self, LightArg, Sky};

#[derive(Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Colour and light (COLOR: see below)")]
#[expect(clippy::struct_excessive_bools, reason = "each is an option")]
pub(crate) struct LightingArgs {
    /// How hits get their colour [default: the file's, else direct; lambert with --ambient or
    /// --light shoulder]
    #[arg(
        long,
        value_name = "NAME",
        value_parser = clap::builder::PossibleValuesParser::new(firsthit::Shader::NAMES),
    )]
    pub(crate) shader: Option<String>,
    /// A setting of the shader, such as reach=2 or shadows=false; may be given several times.
    /// docs/shading.md lists them
    #[arg(long, value_name = "NAME=VALUE", value_parser = values::setting)]
    pub(crate) set: Vec<(String, String)>,
    /// Lights that go with the camera: auto, studio, overcast, sun, headlight, shoulder; or a
    /// light, which may be given several times: directional:X,Y,Z@DEGREES (where it goes, and how
    /// large the sun is), point:X,Y,Z, spot:X,Y,Z:DIRECTION[:INNER:OUTER] (the angles of full and
    /// of all light from the middle, in radians), sphere:CENTER:RADIUS, disc:CENTER:NORMAL:RADIUS
    /// (which shines to the side of its normal), rectangle:CENTER:EDGE:EDGE (to the side from which
    /// the turn from the first edge to the second is counter-clockwise). CENTER, DIRECTION, NORMAL
    /// and EDGE are X,Y,Z [default: the file's, else auto]
    #[arg(long, value_name = "NAME|KIND:X,Y,Z", value_parser = values::light)]
    pub(crate) light: Vec<LightArg>,
    /// Light from all around, in place of the file's: a picture of all directions (.hdr or .exr),
    /// turned by degrees about up; or a clear sky with its sun: elevation above the horizon and
    /// azimuth from +x, in degrees
    #[arg(
        long,
        value_name = "FILE[@DEGREES]|daylight:ELEVATION[,AZIMUTH]",
        value_parser = environment::parse,
    )]
    pub(crate) environment: Option<EnvironmentArg>,
    /// Multiply the --environment by this factor [default: 1]
    #[arg(long, value_name = "NUMBER", value_parser = values::tolerance, requires = "environment")]
    pub(crate) environment_strength: Option<f64>,
    /// Use the --environment as light only; show the background instead
    #[arg(long, requires = "environment")]
    pub(crate) environment_hidden: bool,
    /// A ground under everything, of which only shadows are seen [default: with a set of lights but
    /// shoulder, and a camera above it]
    #[arg(long, overrides_with = "no_ground")]
    pub(crate) ground: bool,
    /// No ground
    #[arg(long)]
    pub(crate) no_ground: bool,
    /// Ambient light, which is the same from all directions, of a shader that has it (lambert,
    /// phong, blinn-phong, ghost, whitted) [default: 0.25,0.25,0.25]
    #[arg(long, value_name = "COLOR", value_parser = values::color)]
    pub(crate) ambient: Option<Color>,
    /// Light surfaces as if nothing cast a shadow
    #[arg(long)]
    pub(crate) no_shadows: bool,
    /// The colour of the objects to which the file gives none [default: 0.6,0.6,0.6]
    #[arg(long, value_name = "COLOR", value_parser = values::color)]
    pub(crate) color: Option<Color>,
    /// The colour where nothing is hit, or transparent [default: 0.12,0.17,0.24]
    #[arg(long, value_name = "COLOR", value_parser = values::background, conflicts_with = "sky")]
    pub(crate) background: Option<Background>,
    /// A sky where nothing is hit: the colours of the horizon and of the zenith
    #[arg(long, value_name = "COLOR:COLOR", value_parser = values::sky)]
    pub(crate) sky: Option<Sky>,
}

/// Lines along edges.
#[derive(Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Edges")]
pub(crate) struct EdgeArgs {
    /// Draw lines along edges over the colours, of this width in pixels; below 1 they are fainter.
    /// The channel edge has their coverage [default: no lines, or the file's; 1 with any of the
    /// options below]
    #[arg(long, value_name = "WIDTH", value_parser = values::line_width)]
    pub(crate) edges: Option<f64>,
    /// Which edges: silhouette (a surface turns away from the eye), crease (its triangles meet at
    /// an angle), boundary (it ends), object (another object is behind, or nothing), material
    /// (between two materials), wireframe (between all polygons), with commas between [default:
    /// silhouette,crease,boundary,material]
    #[arg(long, value_name = "KINDS", value_parser = values::edge_kinds)]
    pub(crate) edge_kinds: Option<EdgeKinds>,
    /// Neighbours whose own normals are more than this many degrees apart meet in a crease
    /// [default: 30]
    #[arg(long, value_name = "DEGREES", value_parser = values::edge_angle)]
    pub(crate) edge_angle: Option<f64>,
    /// The colour of the lines [default: black]
    #[arg(long, value_name = "COLOR", value_parser = values::color)]
    pub(crate) edge_color: Option<Color>,
    /// Draw dashed what something hides: the lengths of dashes and of gaps, in pixels, such as
    /// --hidden-edges=3,2 [default: not at all; 6,4 without lengths]
    #[arg(
        long,
        value_name = "DASH,GAP",
        value_parser = values::dash,
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "6,4",
    )]
    pub(crate) hidden_edges: Option<Dash>,
    /// Draw the edges of all polygons, beside the others
    #[arg(long)]
    pub(crate) wireframe: bool,
    /// Draw no lines, though the file asks for some
    #[arg(
        long,
        conflicts_with_all = ["edges", "edge_kinds", "edge_angle", "edge_color", "hidden_edges", "wireframe"],
    )]
    pub(crate) no_edges: bool,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Colours by numbers")]
#[expect(clippy::struct_field_names, reason = "as the options are called")]
pub(crate) struct ColorsArgs {
    /// Colour surfaces by numbers: attribute:NAME for an attribute of the meshes, object, face,
    /// height, or incidence. The shader lights these colours as others
    #[arg(long, value_name = "WHAT", value_parser = values::color_by)]
    pub(crate) color_by: Option<ColorBy>,
    /// The colour map [default: viridis]
    #[arg(long, value_name = "NAME", value_parser = values::named::<ColorMap>(ColorMap::NAMES))]
    pub(crate) color_map: Option<ColorMap>,
    /// The numbers of the first and the last colour [default: the least and the largest that the
    /// scene has, seen or not]
    #[arg(long, value_name = "MIN,MAX", value_parser = values::range)]
    pub(crate) color_range: Option<[f64; 2]>,
    /// The colour of numbers below the --color-range [default: the map's first]
    #[arg(long, value_name = "COLOR", value_parser = values::color)]
    pub(crate) color_below: Option<Color>,
    /// The colour of numbers above the --color-range [default: the map's last]
    #[arg(long, value_name = "COLOR", value_parser = values::color)]
    pub(crate) color_above: Option<Color>,
    /// The colour where there is no number [default: the surface's own]
    #[arg(long, value_name = "COLOR", value_parser = values::color)]
    pub(crate) color_missing: Option<Color>,
}
