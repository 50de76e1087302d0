// Requests to the server that this page came from. Addresses are relative, so that each holds the token.

async function checked(response) {
  if (response.ok) return response;
  throw new Error((await response.text()) || response.statusText);
}

function address(path, parameters) {
  const query = new URLSearchParams(parameters).toString();
  return query ? `${path}?${query}` : path;
}

// Asks for JSON.
export async function ask(path, parameters = {}) {
  const response = await checked(await fetch(address(`ask/${path}`, parameters)));
  return response.json();
}

// Asks for a picture: a bitmap, and what the server says of it; null if there is none yet.
export async function askPicture(path, parameters = {}) {
  const response = await checked(await fetch(address(`ask/${path}`, parameters)));
  if (response.status === 204) return null;
  const about = JSON.parse(response.headers.get("etalon-about"));
  const bitmap = await createImageBitmap(await response.blob());
  return { bitmap, about };
}

export function saveAddress(path, parameters) {
  return address(`ask/${path}`, parameters);
}

// Orders something.
export async function order(path, body) {
  const response = await fetch(`do/${path}`, {
    method: "POST",
    headers: { "content-type": "application/json" },
    body: JSON.stringify(body),
  });
  return (await checked(response)).json();
}

// How long this waits until it asks a server again that refused.
const AGAIN_MS = 5000;

// Hears of every change. A browser asks again by itself where the connection breaks. Where the server refuses, this asks again.
export function listen(onStatus, onLost) {
  const events = new EventSource("ask/events");
  events.onmessage = (event) => onStatus(JSON.parse(event.data));
  events.onerror = async () => {
    if (events.readyState !== EventSource.CLOSED) {
      onLost("the connection to the server is lost; it is tried again");
      return;
    }
    setTimeout(() => listen(onStatus, onLost), AGAIN_MS);
    const why = await refusal();
    if (why) onLost(`${why}; it is tried again every ${AGAIN_MS / 1000} s`);
  };
}

// Why the server sends no news, which an EventSource does not tell; null if it now would.
async function refusal() {
  const stop = new AbortController();
  try {
    const response = await fetch("ask/events", { signal: stop.signal });
    return response.ok ? null : (await response.text()) || response.statusText;
  } catch {
    return "the server does not answer";
  } finally {
    stop.abort();
  }
}

// Does one thing at a time, and of all that came meanwhile only the last.
export function latest(work) {
  let busy = false;
  let next = null;
  return async function again(...parameters) {
    if (busy) {
      next = parameters;
      return;
    }
    busy = true;
    try {
      await work(...parameters);
    } finally {
      busy = false;
      if (next) {
        const waiting = next;
        next = null;
        again(...waiting);
      }
    }
  };
}
