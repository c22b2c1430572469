// @ts-check
// The camera as other programs read it, and theirs taken.

import { parseCamera } from "./camera-text.js";
import { element, words } from "./dom.js";
import { lookText } from "./look-text.js";
import { copy, say } from "./status.js";

export class CameraPanel {
    /** @param {import("./page.js").Page} page */
    constructor(page) {
        this.page = page;
        element("say-as").addEventListener("change", () => page.tellCamera());
        element("copy-camera").addEventListener("click", () => copy(element("said").textContent));
        element("take-camera").addEventListener("click", () => this.#take());
    }

    /** @param {AbortSignal} ended after which nothing is said any more */
    async tell(ended) {
        const { engine, info, view } = this.page;
        const texts = await engine.cameraText(this.page.flatCamera(...view.shape));
        if (ended.aborted) return;
        const wanted = texts[element("say-as").value];
        const text = typeof wanted === "string" ? wanted : JSON.stringify(wanted);
        const isCommand = element("say-as").value === "command";
        const { options, missing } = lookText(this.page.request(...view.shape), info);
        element("said").textContent = wanted === null ? "Parallel rays have no matrix of pixels." : isCommand ? [text, ...options].join(" ") : text;
        const unsaid = isCommand || options.length === 0 ? missing : [...missing, options.join(" ")];
        element("unsaid").textContent = unsaid.length > 0 ? `Not said here: ${unsaid.join(", ")}.` : "";
    }

    async #take() {
        const { camera, chapter, engine, info, view } = this.page;
        try {
            const [rows, columns] = view.shape;
            const given = parseCamera(element("heard").value, rows, columns, info.up);
            // The engine refuses what is no camera.
            await engine.cameraText(given);
            camera.take(given);
            if (chapter.isOpen) chapter.take(given);
            this.page.showProjection();
            this.page.moved();
        } catch (error) {
            say(words(error), true);
        }
    }
}
