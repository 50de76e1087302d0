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

// Hears of every change. The browser asks again by itself where the connection breaks.
export function listen(onStatus, onLost) {
  const events = new EventSource("ask/events");
  events.onmessage = (event) => onStatus(JSON.parse(event.data));
  events.onerror = onLost;
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
