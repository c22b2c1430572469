// @ts-check
// Hits that are kept: a path that is measured, with notes.

import { disable, download, element, make, plain, words } from "./dom.js";
import { label, MARK, strokeOutlined } from "./label.js";
import { remember, remembered } from "./storage.js";
import { measured } from "./probe-text.js";
import { aligned, readOut } from "./readout.js";
import { say } from "./status.js";

/** @typedef {import("./camera.js").Vector} Vector */
/** @typedef {{hit: any, note: string}} Mark */

export class Marks {
    /** @param {string} title of the scene @param {string} scene what tells it from others of that title @param {() => void} changed */
    constructor(title, scene, changed) {
        this.title = title;
        this.changed = changed;
        /** @type {Mark[]} */
        this.kept = [];
        /** Those that were cleared last. @type {Mark[]} */
        this.cleared = [];
        this.key = `firsthit-notes ${scene}`;
        element("clear").addEventListener("click", () => this.clear());
        element("undo").addEventListener("click", () => this.undo());
        element("save-notes").addEventListener("click", () => {
            const text = JSON.stringify({ title: this.title, marks: this.kept }, null, 2);
            download("notes.json", new Blob([text], { type: "application/json" }));
        });
        element("load-notes").addEventListener("change", async (/** @type {any} */ event) => {
            const [file] = event.target.files;
            if (file) this.#take(await file.text());
            event.target.value = "";
        });
    }

    /** Takes those of before the page was loaded again. */
    restore() {
        this.#take(remembered(this.key) ?? "[]");
    }

    /** @param {any} hit */
    add(hit) {
        this.kept.push({ hit, note: "" });
        this.#show();
    }

    /** Takes the last mark away, or brings those back that were cleared. */
    undo() {
        if (this.kept.length > 0) this.kept.pop();
        else [this.kept, this.cleared] = [this.cleared, []];
        this.#show();
    }

    clear() {
        if (this.kept.length > 0) this.cleared = this.kept;
        this.kept = [];
        this.#show();
    }

    /** Marks of a text: a list, or a file of notes. @param {string} text */
    #take(text) {
        try {
            const given = JSON.parse(text);
            const marks = Array.isArray(given) ? given : given.marks;
            const isMark = (/** @type {any} */ mark) => [mark.hit.position, mark.hit.normal].every((v) => v.length === 3 && v.every(Number.isFinite));
            if (!marks.every(isMark)) throw new Error("its marks have no positions");
            this.kept = marks.map((/** @type {any} */ mark) => ({ hit: mark.hit, note: String(mark.note ?? "") }));
            this.#show();
        } catch (error) {
            say(`These are no notes: ${words(error)}`, true);
        }
    }

    #show() {
        const lines = this.kept.map((mark, k) => {
            const line = make("li");
            const note = make("input", "", { "aria-label": `note on mark ${k + 1}`, placeholder: "note", maxlength: "500" });
            note.value = mark.note;
            note.addEventListener("input", () => {
                mark.note = note.value;
                this.#remember();
                this.changed();
            });
            line.append(note, make("small", `${plain(mark.hit.name || mark.hit.shape || "")} ${aligned(mark.hit.position).join(", ")}`));
            return line;
        });
        element("marks").replaceChildren(...lines);
        const isEmpty = this.kept.length === 0;
        const why = "No point is kept yet: click the picture.";
        for (const id of ["clear", "save-notes"]) disable(id, isEmpty && why);
        disable("undo", isEmpty && this.cleared.length === 0 && why);
        const rows = measured(this.kept.map((mark) => mark.hit));
        element("measure").hidden = rows.length === 0;
        readOut(element("measure"), rows);
        this.#remember();
        this.changed();
    }

    #remember() {
        remember(this.key, JSON.stringify(this.kept));
    }

    /** Draws them. @param {CanvasRenderingContext2D} on @param {(point: Vector) => [number, number] | null} pixelOf */
    draw(on, pixelOf) {
        const places = this.kept.map((mark) => pixelOf(mark.hit.position));
        on.beginPath();
        places.forEach((place, k) => {
            if (!place) return;
            const before = places[k - 1];
            if (before) {
                on.moveTo(...before);
                on.lineTo(...place);
            }
            on.moveTo(place[0] + 5, place[1]);
            on.arc(place[0], place[1], 5, 0, 2 * Math.PI);
        });
        strokeOutlined(on, MARK, 2);
        places.forEach((place, k) => {
            if (place) label(on, `${k + 1} ${this.kept[k].note}`.trim(), place);
        });
    }
}
