// @ts-check
// The start of the page, and its new start with a file that is dropped on it.

import { element, words } from "./dom.js";
import { engineOfFile, engineOfPage } from "./engines.js";
import { Page } from "./page.js";
import { say } from "./status.js";

/** The page's elements before anything was done to them. */
const pristine = [...document.body.childNodes].map((node) => node.cloneNode(true));
/** @type {Page | null} */
let page = null;
/** So often the page tells its first engine that it is there, in milliseconds. */
const ALIVE = 5_000;
/** How many files were opened. */
let opened = 0;

/** Shows what an engine has, in place of what is shown. @param {import("./engine.js").Engine} engine */
async function show(engine) {
    const info = await engine.info();
    if (page) {
        page.end();
        document.body.replaceChildren(...pristine.map((node) => node.cloneNode(true)));
        delete document.body.dataset.ready;
        delete document.body.dataset.painted;
    }
    page = new Page(engine, info, open);
}

/** @param {File} file */
async function open(file) {
    const number = ++opened;
    say(`Reading ${file.name} ...`, false);
    try {
        const engine = await engineOfFile(file);
        // A later one may have been read sooner.
        if (number === opened) await show(engine);
        else engine.close();
    } catch (error) {
        say(words(error), true);
    }
}

addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => {
    event.preventDefault();
    const file = event.dataTransfer?.files[0];
    if (file) open(file);
});
try {
    say("Loading ...", false);
    const first = await engineOfPage();
    await show(first);
    // Whatever is shown later: it serves the page, and files to come need it.
    setInterval(() => first.alive().catch((error) => say(words(error), true)), ALIVE);
    // part.html#chapter begins with that section. The address of a served page has its token there.
    const section = element("report-engine") && element(location.hash.slice(1));
    if (section instanceof HTMLDetailsElement) {
        section.open = true;
        section.scrollIntoView();
    }
} catch (error) {
    element("title").textContent = "firsthit";
    say(words(error), true);
}
