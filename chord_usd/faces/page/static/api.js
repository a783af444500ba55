// What the server is asked.

/** A request whose answer is JSON. Throws an Error with the server's own sentence. */
export async function ask(method, path, body) {
  const raw = body instanceof Blob;
  let answer;
  try {
    answer = await fetch(path, {
      method,
      // Else a plan.json would be taken for something said.
      headers: body === undefined ? {} : { "content-type": raw ? "application/octet-stream" : "application/json" },
      body: body === undefined ? undefined : raw ? body : JSON.stringify(body),
    });
  } catch {
    throw new Error("The server does not answer: it may have been ended.");
  }
  const told = await answer.json().catch(() => ({}));
  if (!answer.ok) {
    throw Object.assign(new Error(told.error || `The server answered ${answer.status}.`), {
      status: answer.status,
    });
  }
  return told;
}

export const get = (path) => ask("GET", path);
export const post = (path, body) => ask("POST", path, body);

export const houses = () => get("/api/houses");
export const house = (id) => get(`/api/houses/${id}`);
export const choices = () => get("/api/choices");

/** Ask for a job; returns it. */
export const job = (id, kind, given = {}) => post(`/api/houses/${id}/jobs`, { kind, given });

export const isOver = (job) => !["queued", "running"].includes(job.state);

/** Address of a file of a version. */
export const file = (id, version, kind, name) =>
  `/api/houses/${id}/versions/${version}/${kind}/${name}`;

/** Work that is asked for while it runs is done after that: what changes meanwhile builds on it. */
export function oneAtATime(work) {
  let last = Promise.resolve();
  return () => (last = last.catch(() => {}).then(work));
}
