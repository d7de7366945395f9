// The page around the program: loads it, says how far it is, and gives it what only a page can.
import init, * as program from "./quadfront.js";

const element = (name) => document.getElementById(name);

// The page as one file, where it is one: before anything in it changes.
const wholePage = element("program") && `<!DOCTYPE html>\n${document.documentElement.outerHTML}`;

// ---- what the program asks of the page (src/app/window/web/page.rs, src/app/tasks/web.rs) ----

// The name of this page among those of its address, which a lock tells the others as long as the page is open.
const own = Math.random().toString(36).slice(2, 10);
const LOCK = "quadfront ";
const KEPT = "quadfront/";
let alive = new Set();

async function lookAround() {
    const { held, pending } = await navigator.locks.query();
    const names = [...held, ...pending].map((lock) => lock.name);
    alive = new Set(names.filter((name) => name.startsWith(LOCK)).map((name) => name.slice(LOCK.length)));
}

// Whether runs can be kept here: there is storage, and locks tell which page a run belongs to.
let keeps = false;
try {
    localStorage.getItem(KEPT);
    navigator.locks.request(LOCK + own, () => new Promise(() => {}));
    await lookAround();
    setInterval(lookAround, 5000);
    keeps = true;
} catch {
    // A page in a frame without rights has neither.
}

// Tasks begin by messages, which come at once: a timer of zero milliseconds waits for at least four.
const messages = new MessageChannel();
const waiting = [];
messages.port1.onmessage = () => waiting.shift()();
function soon(call) {
    waiting.push(call);
    messages.port2.postMessage(null);
}

// Whether this browser can suspend a program (JavaScript Promise Integration).
const suspends = Boolean(WebAssembly.promising && WebAssembly.Suspending);

globalThis.quadfront = {
    program,
    later: (milliseconds) => (milliseconds ? setTimeout(program.runTask, milliseconds) : soon(program.runTask)),
    // A task that gives way goes on later by itself. One that cannot must not begin within a frame: when it ends, the
    // program takes the stack to be empty.
    now() {
        if (suspends) program.runTask();
        return suspends;
    },
    giveWay: () => new Promise((goOn) => soon(goOn)),
    own: () => own,
    async template() {
        if (wholePage) return wholePage;
        const answer = await fetch("quadfront-page.html");
        if (!answer.ok) throw `the server answers ${answer.status} for quadfront-page.html`;
        return answer.text();
    },
    isAlive: (name) => alive.has(name),
    download(name, bytes) {
        const link = document.createElement("a");
        link.href = URL.createObjectURL(new Blob([bytes]));
        link.download = name;
        link.click();
        // The browser takes the bytes after this.
        setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
    },
    stored() {
        if (!keeps) return undefined;
        const names = Object.keys(localStorage).filter((name) => name.startsWith(KEPT));
        return names.flatMap((name) => [name.slice(KEPT.length), localStorage.getItem(name)]);
    },
    store(name, text) {
        try {
            if (text === undefined) localStorage.removeItem(KEPT + name);
            else localStorage.setItem(KEPT + name, text);
        } catch {
            return "the browser keeps no more for this page";
        }
    },
    tell(title, heading, description, lesson) {
        document.title = title;
        element("heading").textContent = heading;
        element("narration").textContent = description;
        // A paragraph of its own for each; what stays is not said again.
        const paragraphs = lesson.split("\n").filter((line) => line.trim());
        const shown = element("lesson");
        paragraphs.forEach((text, k) => {
            const paragraph = shown.children[k] ?? shown.appendChild(document.createElement("p"));
            if (paragraph.textContent !== text) paragraph.textContent = text;
        });
        while (shown.children.length > paragraphs.length) shown.lastChild.remove();
    },
};

// ---- the program ----

// A browser that cannot suspend a program runs each of its tasks to its end.
if (!suspends) {
    WebAssembly.promising = (call) => async (...given) => call(...given);
    WebAssembly.Suspending = function () {
        return () => {};
    };
}

function say(text) {
    element("said").textContent = text;
}

let hasFailed = false;
function fail(text) {
    if (hasFailed) return;
    hasFailed = true;
    element("bar").hidden = true;
    element("cover").hidden = false;
    say(text);
}
const told = (error) => String(error?.message ?? error);
addEventListener("error", (event) => fail(`The program has stopped: ${event.message}. Load the page again.`));
addEventListener("unhandledrejection", (event) => {
    fail(`The program has stopped: ${told(event.reason)}. Load the page again.`);
});

const megabytes = (bytes) => `${(bytes / 1e6).toFixed(1)} MB`;

// The bytes of the program, with the bar following them.
function watched(body) {
    const all = Number(document.querySelector("meta[name=quadfront-size]")?.content);
    let loaded = 0;
    const count = new TransformStream({
        transform(bytes, next) {
            loaded += bytes.length;
            if (all) element("bar").value = Math.min(loaded / all, 1);
            say(`The program is being loaded: ${megabytes(loaded)}${all ? ` of ${megabytes(all)}` : ""}.`);
            next.enqueue(bytes);
        },
    });
    return body.pipeThrough(count);
}

// What is compressed is opened; a server may have done that already.
async function opened(body) {
    const [first, rest] = body.tee();
    const reader = first.getReader();
    const { value } = await reader.read();
    reader.cancel();
    const isCompressed = value?.[0] === 0x1f && value?.[1] === 0x8b;
    return isCompressed ? rest.pipeThrough(new DecompressionStream("gzip")) : rest;
}

async function source() {
    const inside = element("program");
    let body;
    if (inside) {
        body = new Blob([Uint8Array.from(atob(inside.textContent), (c) => c.charCodeAt(0))]).stream();
        inside.remove();
    } else {
        const answer = await fetch("quadfront.wasm.gz");
        if (!answer.ok) throw new Error(`the server answers ${answer.status} for quadfront.wasm.gz`);
        body = answer.body;
    }
    return new Response(watched(await opened(body)), { headers: { "Content-Type": "application/wasm" } });
}

try {
    await init({ module_or_path: source() });
    say("The window is being opened.");
    const graphics = document.createElement("canvas");
    if (!navigator.gpu && !graphics.getContext("webgl2")) {
        throw new Error("this browser has neither WebGPU nor WebGL 2, which it draws with");
    }
    graphics.getContext("webgl2")?.getExtension("WEBGL_lose_context")?.loseContext();
    element("window").hidden = false;
    await program.start("window", location.hash.length > 1 ? location.hash : "", element("content").textContent);
    addEventListener("hashchange", () => program.openLink(location.hash));
    for (const [keys, what] of JSON.parse(program.keysInWords())) {
        element("keys").append(
            Object.assign(document.createElement("dt"), { textContent: keys }),
            Object.assign(document.createElement("dd"), { textContent: what }),
        );
    }
    element("cover").hidden = true;
    element("window").focus();
} catch (error) {
    fail(`quadfront cannot be opened here: ${told(error)}.`);
}
