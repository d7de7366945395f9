// Starts the program, which is in the page or beside it, and says what it exports.
import init, * as program from "./quadfront.js";

const inside = document.getElementById("program");
let source;
if (inside) {
    const bytes = Uint8Array.from(atob(inside.textContent), (c) => c.charCodeAt(0));
    source = new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip")), {
        headers: { "Content-Type": "application/wasm" },
    });
} else {
    source = fetch("quadfront.wasm");
}
await init({ module_or_path: source });
// The end of a script, in a string.
document.getElementById("said").textContent = `</script> ${Object.keys(program).sort().join(" ")}`;
