// The motions of a page that plays them, and their time span.

const tracks = JSON.parse(document.getElementById("motions").textContent);
const startTime = Math.min(...tracks.map((track) => track.t[0]));
const endTime = Math.max(...tracks.map((track) => track.t.at(-1)));
