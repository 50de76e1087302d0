//! `etalon schema`: the JSON Schemas of scene and sensor files, for editors.

use etalon::SensorFile;

use crate::failure::Outcome;
use crate::print;

/// Print the JSON Schema of scene files or sensor files, so that an editor can complete and check them.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  etalon schema > scenes/etalon.schema.json
  etalon schema sensor > scenes/sensors/sensor.schema.json")]
pub(crate) struct SchemaArgs {
    /// Kind of file.
    #[arg(value_enum, default_value_t = SchemaKind::Scene)]
    kind: SchemaKind,
}

/// A kind of file with a schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum SchemaKind {
    /// A scene, for most commands.
    Scene,
    /// An image sensor, for `etalon expose`.
    Sensor,
}

pub(crate) fn run(args: SchemaArgs) -> Outcome {
    print::json(&match args.kind {
        SchemaKind::Scene => etalon_scene::schema(),
        SchemaKind::Sensor => SensorFile::schema(),
    });
    Ok(())
}
