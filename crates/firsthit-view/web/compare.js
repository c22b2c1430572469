// @ts-check
// Two pictures side by side: one that was kept, and the one that is shown, with a line to drag between them.

import { element, six } from "./dom.js";

/** @typedef {{rows: number, columns: number, pixels: Uint8ClampedArray, values: Float32Array | Int32Array | null, name: string, isDone: boolean}} Shown */

export class Compare {
    /** @param {() => Shown | null} shown the picture that the page shows */
    constructor(shown) {
        this.shown = shown;
        /** @type {Shown | null} */
        this.kept = null;
        /** Whether the next picture that is done is to be kept. */
        this.isWaiting = false;
        element("keep-picture").addEventListener("click", () => {
            this.isWaiting = true;
            this.draw();
        });
        element("forget-picture").addEventListener("click", () => {
            [this.kept, this.isWaiting] = [null, false];
            this.draw();
        });
        element("split").addEventListener("input", () => this.draw());
    }

    /** Paints the left part of the kept picture over the new one, and says how they differ. */
    draw() {
        const now = this.shown();
        // One of few samples would differ from any other.
        if (this.isWaiting && now?.isDone) [this.kept, this.isWaiting] = [now, false];
        const { kept, isWaiting } = this;
        const canvas = element("before");
        const isSame = kept && now && kept.rows === now.rows && kept.columns === now.columns;
        canvas.hidden = !isSame;
        element("split-label").hidden = element("forget-picture").hidden = kept === null && !isWaiting;
        element("difference").textContent = isWaiting ? "It is kept when it is done." : isSame ? (now.isDone ? difference(kept, now) : "") : kept && now ? "The kept picture has another size." : "";
        if (!isSame) return;
        [canvas.width, canvas.height] = [kept.columns, kept.rows];
        const columns = Math.round(element("split").value * kept.columns);
        const on = canvas.getContext("2d");
        on.putImageData(new ImageData(/** @type {any} */ (kept.pixels), kept.columns, kept.rows), 0, 0, 0, 0, columns, kept.rows);
        on.fillStyle = "#ffd166";
        on.fillRect(Math.max(0, columns - 1), 0, 2, kept.rows);
    }
}

/** How two pictures differ: numbers where both are of one channel, else colours. @param {Shown} a @param {Shown} b @returns {string} */
function difference(a, b) {
    const isNumbers = a.values && b.values && a.name === b.name && a.values.length === b.values.length;
    const [before, after] = isNumbers ? [/** @type {Float32Array} */ (a.values), /** @type {Float32Array} */ (b.values)] : [a.pixels, b.pixels];
    const each = before.length / (a.rows * a.columns);
    let [different, largest, sum] = [0, 0, 0];
    for (let first = 0; first < before.length; first += each) {
        let isDifferent = false;
        for (let k = first; k < first + each; k++) {
            const [x, y] = [before[k], after[k]];
            if (x === y || (Number.isNaN(x) && Number.isNaN(y))) continue;
            isDifferent = true;
            const apart = Math.abs(x - y);
            largest = Math.max(largest, Number.isFinite(apart) ? apart : Infinity);
            sum += Number.isFinite(apart) ? apart : 0;
        }
        if (isDifferent) different++;
    }
    const pixels = a.rows * a.columns;
    const what = isNumbers ? a.name : "levels of 255";
    if (different === 0) return "No pixel differs.";
    const mean = sum / before.length;
    return `${different} of ${pixels} pixels differ, by at most ${largest === Infinity ? "a hit where there was none" : six(largest)} (${what}); mean ${six(mean)}`;
}
