// The error of the picture against time, both on logarithmic axes: measured, and predicted.

import { percent, roundedSeconds, seconds, svg } from "./format.js";

export const MARKS = [0.05, 0.02, 0.01];
const SPACE = { left: 42, right: 12, top: 10, bottom: 26 };

// Seconds and errors that are named on the axes.
const TIMES = [0.01, 0.1, 1, 10, 60, 600, 3600, 36000, 360000];
const ERRORS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50];

export function drawCurve(element, status) {
  const { width, height } = element.getBoundingClientRect();
  if (width === 0) return;
  const measured = status.curve.filter((p) => p.relative_rmse > 0 && p.seconds > 0);
  const target = status.target ?? 0.01;
  const predicted = ahead(status);
  const times = [...measured.map((p) => p.seconds), ...predicted.filter((p) => p.relative_rmse >= 0.7 * Math.min(target, 0.01)).map((p) => p.seconds)];
  const errors = measured.map((p) => p.relative_rmse);
  const [t0, t1] = widened(times.length ? Math.min(...times) : 0.1, times.length ? Math.max(...times) : 10, 1.25);
  const [e0, e1] = widened(Math.min(...errors, 0.01, target), Math.max(...errors, 0.3), 1.15);
  const x = (t) => SPACE.left + ((Math.log(t) - Math.log(t0)) / (Math.log(t1) - Math.log(t0))) * (width - SPACE.left - SPACE.right);
  const y = (e) => SPACE.top + ((Math.log(e1) - Math.log(e)) / (Math.log(e1) - Math.log(e0))) * (height - SPACE.top - SPACE.bottom);
  const shown = (t) => t >= t0 && t <= t1;
  const parts = [];
  const text = (at, words, more = {}) => parts.push(svg("text", { x: at[0], y: at[1], ...more }, words));
  const line = (a, b, more) => parts.push(svg("line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1], ...more }));
  const bottom = height - SPACE.bottom;

  text([width - SPACE.right, height - 10], "time", { "text-anchor": "end", class: "strong" });
  for (const t of TIMES.filter((t) => shown(t) && x(t) < width - 56)) {
    line([x(t), SPACE.top], [x(t), bottom], { stroke: "#2c2f33" });
    text([x(t), height - 10], seconds(t), { "text-anchor": "middle" });
  }
  let free = Infinity;
  for (const e of ERRORS.filter((e) => e >= e0 && e <= e1)) {
    const isMark = MARKS.includes(e);
    line([SPACE.left, y(e)], [width - SPACE.right, y(e)], isMark ? { stroke: "#5a5d62", "stroke-dasharray": "1 4" } : { stroke: "#2c2f33" });
    if (free - y(e) < 13) continue;
    free = y(e);
    text([SPACE.left - 6, y(e) + 4], percent(e), { "text-anchor": "end", class: isMark ? "strong" : "" });
  }

  // The prediction with its interval.
  if (predicted.length > 1) {
    const clip = (t) => Math.min(Math.max(t, t0), t1);
    const upper = predicted.map((p) => `${x(clip(p.seconds_interval[1] ?? t1))},${y(p.relative_rmse)}`);
    const lower = predicted.map((p) => `${x(clip(p.seconds_interval[0] ?? t0))},${y(p.relative_rmse)}`).reverse();
    const inside = svg("clipPath", { id: "inside" });
    inside.append(svg("rect", { x: SPACE.left, y: SPACE.top, width: width - SPACE.left - SPACE.right, height: bottom - SPACE.top }));
    parts.push(inside);
    parts.push(svg("polygon", { points: [...upper, ...lower].join(" "), fill: "#7fb2d6", opacity: 0.3, "clip-path": "url(#inside)" }));
    const points = predicted.map((p) => `${x(p.seconds)},${y(p.relative_rmse)}`).join(" ");
    parts.push(svg("polyline", { points, fill: "none", stroke: "#7fb2d6", "stroke-dasharray": "5 4", "stroke-width": 1.5, "clip-path": "url(#inside)" }));
    for (const p of predicted.filter((p) => (MARKS.includes(p.relative_rmse) || p.relative_rmse === status.target) && shown(p.seconds))) {
      parts.push(svg("circle", { cx: x(p.seconds), cy: y(p.relative_rmse), r: 3, fill: "#7fb2d6" }));
      line([x(p.seconds), y(p.relative_rmse)], [x(p.seconds), bottom], { stroke: "#7fb2d6", opacity: 0.35 });
    }
  }

  // What was measured.
  const own = measured.filter((p) => p.block === 1);
  const band = own.filter((p) => p.interval);
  if (band.length > 1) {
    const upper = band.map((p) => `${x(p.seconds)},${y(p.interval[1])}`);
    const lower = band.map((p) => `${x(p.seconds)},${y(p.interval[0])}`).reverse();
    parts.push(svg("polygon", { points: [...upper, ...lower].join(" "), fill: "#e0a458", opacity: 0.3 }));
  }
  parts.push(svg("polyline", { points: own.map((p) => `${x(p.seconds)},${y(p.relative_rmse)}`).join(" "), fill: "none", stroke: "#e0a458", "stroke-width": 2, "stroke-linejoin": "round" }));
  for (const p of measured.filter((p) => p.block > 1)) {
    parts.push(svg("circle", { cx: x(p.seconds), cy: y(p.relative_rmse), r: 3, fill: "none", stroke: "#e0a458" }));
  }
  const last = own.at(-1);
  if (last) parts.push(svg("circle", { cx: x(last.seconds), cy: y(last.relative_rmse), r: 4, fill: "#e0a458" }));

  // What the lines are: in the lower left corner, because errors fall.
  const names = [["#e0a458", "error of the picture", ""]];
  if (measured.some((p) => p.block > 1)) names.push(["#e0a458", "coarse pictures (not comparable)", null]);
  if (predicted.length > 1) names.push(["#7fb2d6", "prediction (band: 95 % sure)", "5 4"]);
  const left = SPACE.left + 8;
  names.forEach(([colour, name, dash], index) => {
    const at = bottom - 10 - 15 * (names.length - 1 - index);
    if (dash === null) parts.push(svg("circle", { cx: left + 10, cy: at, r: 3, fill: "none", stroke: colour }));
    else line([left, at], [left + 20, at], { stroke: colour, "stroke-width": 2, "stroke-dasharray": dash });
    text([left + 26, at + 4], name, { class: "backed" });
  });
  element.replaceChildren(...parts);
}

// The prediction from now on: at the rate of now, and with the stated error as one of its points. The pilot knew only its own rate.
function ahead(status) {
  const begun = status.block === 1 && status.paths_per_second > 0 && status.samples > 0;
  const pixels = status.size[0] * status.size[1];
  const points = [...status.predicted];
  const samples = status.target ? between(points, status.target) : null;
  if (samples !== null && !points.some((p) => p.relative_rmse === status.target)) {
    const after = points.findIndex((p) => p.relative_rmse < status.target);
    const like = points[after];
    const share = samples / like.samples;
    points.splice(after, 0, { relative_rmse: status.target, samples, seconds: like.seconds * share, seconds_interval: like.seconds_interval.map((t) => (t === null ? null : t * share)) });
  }
  if (!begun) return points.filter((p) => p.seconds > 0);
  // The line goes on from the newest measured point.
  const newest = status.curve.filter((p) => p.block === 1 && p.relative_rmse > 0 && p.seconds > 0).at(-1);
  const isAhead = (p) => p.samples > status.samples && p.relative_rmse < (newest?.relative_rmse ?? Infinity);
  const later = points.filter(isAhead).map((p) => {
    const seconds = status.seconds + ((p.samples - status.samples) * pixels) / status.paths_per_second;
    const atRate = (t) => (t === null ? null : Math.max(status.seconds, (t * seconds) / p.seconds));
    return { ...p, seconds, seconds_interval: p.seconds_interval.map(atRate) };
  });
  return newest && later.length > 0 ? [{ ...newest, seconds_interval: [newest.seconds, newest.seconds] }, ...later] : later;
}

function widened(low, high, factor) {
  return high > 1.5 * low ? [low / factor, high * factor] : [low / 2, high * 2];
}

// When each mark is reached, in words, and how sure that is: from the samples that it is predicted to take and the rate of now.
export function whenReached(status, error) {
  const passed = crossing(status.curve.filter((p) => p.block === 1), error);
  const reached = status.error?.relative_rmse <= error && status.block === 1;
  if (reached && passed !== null) return { words: `reached after ${seconds(passed)}`, reached: true };
  if (status.phase === "done" && error === status.target) {
    return { words: `stopped: its planned ${status.samples} samples gave ${percent(status.error?.relative_rmse)}`, reached: false };
  }
  const predicted = between(status.predicted, error);
  if (predicted === null) return { words: status.phase === "pilot" || status.phase === "coarse" ? "estimate follows" : "no estimate", reached: false };
  const left = (predicted - status.samples * (status.block === 1 ? 1 : 0)) * status.size[0] * status.size[1];
  const rate = status.paths_per_second;
  if (rate > 0 && status.block === 1 && left > 0) {
    const rest = left / rate;
    // As they are written, now and the rest add up to the end.
    const end = roundedSeconds(status.seconds) + roundedSeconds(rest);
    const interval = ahead(status).find((p) => p.relative_rmse === error)?.seconds_interval ?? [null];
    const sure = interval.includes(null) ? "" : `${percent(error)} after ${seconds(interval[0])} to ${seconds(interval[1])} (95 % sure)`;
    return { words: `${seconds(rest)} from now (${seconds(end)} after the start)`, sure, reached: false };
  }
  const known = status.predicted.find((p) => p.relative_rmse === error);
  return { words: known ? `about ${seconds(Math.max(0, known.seconds - status.seconds))} from now` : "soon", reached: false };
}

// When the curve passed an error, as a power of it between the two points about it.
function crossing(own, error) {
  const index = own.findIndex((p) => p.relative_rmse <= error);
  if (index <= 0) return index === 0 ? own[0].seconds : null;
  const [a, b] = [own[index - 1], own[index]];
  const share = Math.log(a.relative_rmse / error) / Math.log(a.relative_rmse / b.relative_rmse);
  return a.seconds * (b.seconds / a.seconds) ** share;
}

// Samples for an error, as a power of it between those that are predicted.
function between(predicted, error) {
  for (let i = 0; i < predicted.length; i += 1) {
    if (predicted[i].relative_rmse === error) return predicted[i].samples;
    if (i > 0 && predicted[i - 1].relative_rmse > error && error > predicted[i].relative_rmse) {
      const [a, b] = [predicted[i - 1], predicted[i]];
      const share = Math.log(a.relative_rmse / error) / Math.log(a.relative_rmse / b.relative_rmse);
      return a.samples * (b.samples / a.samples) ** share;
    }
  }
  return null;
}
