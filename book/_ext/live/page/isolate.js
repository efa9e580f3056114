// A service worker for this site's folder and what is below: it adds two headers that let a page share
// memory with its Python, so that *Stop* is heard in the middle of a loop. It keeps and fetches nothing
// itself. *Run this page* registers it, *Erase* removes it.
addEventListener("install", () => skipWaiting());
addEventListener("fetch", (event) => {
  const { request } = event;
  if (request.mode === "navigate" || request.destination === "worker")
    event.respondWith(fetch(request).then(isolated));
});

function isolated(answer) {
  if (answer.status === 0) return answer; // the browser follows it elsewhere
  const headers = new Headers(answer.headers);
  headers.set("Cross-Origin-Embedder-Policy", "require-corp");
  headers.set("Cross-Origin-Opener-Policy", "same-origin");
  const { status, statusText } = answer;
  return new Response(answer.body, { headers, status, statusText });
}
