// Numbers as people read them.

// 0.0213 → "2.1 %". Two digits, because an error is not known better.
export function percent(share) {
  if (share === null || share === undefined || !Number.isFinite(share)) return "unknown";
  return `${digits(100 * share, 2)} %`;
}

// So many significant digits, without an exponent where that is readable.
export function digits(value, count) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "unknown";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(count - 1).replace("e+", "e").replace("-", "−");
  const decimals = Math.max(0, count - 1 - Math.floor(Math.log10(size)));
  const rounded = Number(value.toPrecision(Math.max(count, Math.ceil(Math.log10(size)))));
  return rounded.toFixed(Math.min(decimals, 8)).replace("-", "−");
}

// A value with its standard error, both to the same decimal place.
export function withError(value, error) {
  if (value === null || value === undefined) return "unknown";
  if (error === null || error === undefined || !Number.isFinite(error)) return `${digits(value, 4)} (error unknown)`;
  if (error === 0) return `${digits(value, 6)} exactly`;
  const exponent = Math.floor(Math.log10(Math.max(Math.abs(value), error)));
  const decimals = 1 - Math.floor(Math.log10(error));
  if (exponent > 5 || exponent < -4) {
    const unit = 10 ** exponent;
    const places = Math.max(0, decimals + exponent);
    return `(${(value / unit).toFixed(places)} ± ${(error / unit).toFixed(places)}) · 10${superscript(exponent)}`.replaceAll("-", "−");
  }
  const places = Math.min(Math.max(decimals, 0), 10);
  return `${value.toFixed(places)} ± ${error.toFixed(places)}`.replaceAll("-", "−");
}

function superscript(number) {
  return String(number).replace(/[-0-9]/g, (c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(c)] ?? "⁻");
}

export function seconds(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "unknown";
  const shown = roundedSeconds(value);
  if (value < 0.0995) return `${Math.round(1000 * value)} ms`;
  if (value < 9.95) return `${value.toFixed(1)} s`;
  if (shown < 120) return `${shown} s`;
  if (shown < 3600) return `${Math.floor(shown / 60)} min ${shown % 60} s`.replace(" 0 s", "");
  if (shown < 172800) return `${Math.floor(shown / 3600)} h ${(shown % 3600) / 60} min`.replace(" 0 min", "");
  return `${shown / 86400} days`;
}

// The number of seconds that `seconds` writes of a value.
export function roundedSeconds(value) {
  const steps = [[0.0995, 0.001], [9.95, 0.1], [3599.5, 1], [172770, 60], [Infinity, 86400]];
  const [, step] = steps.find(([end]) => value < end) ?? steps.at(-1);
  return Math.round(value / step) * step;
}

// The pixels of a tile. Its right and bottom ends are not part of it.
export function tileName([left, right, top, bottom]) {
  const range = (name, begin, end) => (end - begin > 1 ? `${name}s ${begin} to ${end - 1}` : `${name} ${begin}`);
  return `${range("column", left, right)}, ${range("row", top, bottom)}`;
}

export function count(value) {
  if (value === null || value === undefined) return "unknown";
  if (value < 1e4) return String(Math.round(value));
  if (value < 1e6) return `${digits(value / 1e3, 3)} thousand`;
  if (value < 1e9) return `${digits(value / 1e6, 3)} million`;
  return `${digits(value / 1e9, 3)} thousand million`;
}

// Linear Rec. 709 to an sRGB colour for the page.
export function cssColour(rgb, scale = 1) {
  const level = (v) => {
    const c = Math.min(1, Math.max(0, v * scale));
    return Math.round(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055));
  };
  return `rgb(${rgb.map(level).join(" ")})`;
}

// An SVG element.
export function svg(name, attributes = {}, text = null) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== null) element.textContent = text;
  return element;
}

// An HTML element with children or texts. Texts are never read as HTML.
export function html(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key in element && typeof value !== "string") element[key] = value;
    else element.setAttribute(key, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}
