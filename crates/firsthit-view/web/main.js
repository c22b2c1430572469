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
    say(`Reading ${file.name} ...`, false);
    try {
        await show(await engineOfFile(file));
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
    await show(await engineOfPage());
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
