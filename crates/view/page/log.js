// What happened, and when: read by tests and by whoever opens the console. Times are milliseconds since the page began to load.

const entries = [];
window.etalonLog = entries;

export function log(what, details = {}) {
  const entry = { at_ms: performance.now(), what, ...details };
  entries.push(entry);
  if (entries.length > 5000) entries.splice(0, 1000);
  console.debug("etalon", entry);
}
