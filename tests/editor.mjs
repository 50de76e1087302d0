// What the JSON language service of Visual Studio Code makes of the schema: mistakes and completions.
//   node tests/editor.mjs SCHEMA.json SCENE.json
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const require = createRequire(process.cwd() + "/");
const { getLanguageService } = require("vscode-json-languageservice");
const { TextDocument } = require("vscode-languageserver-textdocument");

const [schemaFile, sceneFile] = process.argv.slice(2);
const schema = JSON.parse(readFileSync(schemaFile, "utf8"));
const scene = JSON.parse(readFileSync(sceneFile, "utf8"));
// The schema is given below, not loaded.
delete scene["$schema"];
const service = getLanguageService({});
service.configure({ validate: true, schemas: [{ uri: "etalon", fileMatch: ["*.json"], schema }] });

const documentOf = (text) => {
  const document = TextDocument.create("file:///scene.json", "json", 1, text);
  return [document, service.parseJSONDocument(document)];
};

// The messages about a text, each with the text that is underlined.
async function mistakes(text) {
  const [document, parsed] = documentOf(text);
  const found = await service.doValidation(document, parsed, { comments: "error", trailingCommas: "error" });
  return found.map(({ message, range }) => ({ message, at: document.getText(range) }));
}

// The words that are offered where `|` stands.
async function offered(text) {
  const [document, parsed] = documentOf(text.replace("|", ""));
  const list = await service.doComplete(document, document.positionAt(text.indexOf("|")), parsed);
  return list.items.map((item) => item.label.replaceAll('"', ""));
}

// The scene with another value at a path.
function changed(path, value) {
  const copy = structuredClone(scene);
  const keys = path.split("/");
  const last = keys.pop();
  const parent = keys.reduce((at, key) => at[key], copy);
  parent[last] = value;
  return JSON.stringify(copy, null, 1);
}

let failures = 0;
function expect(what, right, found) {
  if (!right) {
    failures += 1;
    console.error(`${what}: ${JSON.stringify(found)}`);
  }
}

expect("the scene is right", (await mistakes(JSON.stringify(scene))).length === 0, await mistakes(JSON.stringify(scene)));

// Ten mistakes: the path, the wrong value, what is underlined, and words that the message has.
for (const [path, value, at, words] of [
  ["materials/lambert/type", "diffuse", '"diffuse"', ["lambert", "dielectric", "black"]],
  ["objects/0/shape/type", "rectangle", '"rectangle"', ["sphere", "parallelogram", "mesh"]],
  ["lights/0/type", "area", '"area"', ["point", "directional", "environment"]],
  ["camera/type", "pinhole", '"pinhole"', ["perspective", "orthographic"]],
  ["spectra/red/type", "srgb", '"srgb"', ["rgb", "tabulated", "blackbody"]],
  ["materials/glass/interior", "BK7", '"BK7"', ["N-BK7", "water"]],
  ["materials/gold/metal", "gold", '"gold"', ["Ag", "Au"]],
  ["integrator/sampler", "halton", '"halton"', ["sobol", "independent"]],
  ["objects/0/shape/radus_m", 1, '"radus_m"', ["radus_m"]],
  ["materials/lambert/reflectance", "RED", null, []],
  ["materials/clay/roughness", 2, "2", ["1"]],
]) {
  const found = await mistakes(changed(path, value));
  if (at === null) {
    // A name: only the program knows which there are.
    expect(path, found.length === 0, found);
    continue;
  }
  const [one] = found;
  expect(path, found.length === 1 && one.at === at && words.every((word) => one.message.includes(word)), found);
}

// The words that are offered.
for (const [text, words] of [
  ['{ "materials": { "m": { "type": | } } }', ["lambert", "mirror", "conductor", "dielectric", "blend", "black"]],
  ['{ "materials": { "m": { "type": "dielectric", | } } }', ["interior", "exterior", "alpha", "priority"]],
  ['{ "materials": { "m": { "type": "dielectric", "interior": | } } }', ["N-BK7", "water"]],
  ['{ "objects": [{ "shape": { "type": "sphere", | } }] }', ["center_m", "radius_m"]],
  ['{ "objects": [{ "material": { "type": "lambert", "reflectance": { "type": "rgb", | } } }] }', ["rgb"]],
  ['{ "lights": [{ "type": "spot", | }] }', ["half_angle_deg", "intensity"]],
]) {
  const found = await offered(text);
  expect(text, words.every((word) => found.includes(word)), found);
  expect(`${text}: a key of another kind`, !found.includes("look_at_m"), found);
}
process.exit(failures === 0 ? 0 : 1);
