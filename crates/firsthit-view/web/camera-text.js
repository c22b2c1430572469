// @ts-check
// A camera from text: what the page writes of its own, and what other programs write of theirs.

/** @typedef {import("./engine.js").FlatCamera} FlatCamera */

const NUMBER = "[-+]?(?:\\d+\\.?\\d*|\\.\\d+)(?:e[-+]?\\d+)?";
const FAILURE = "This is no camera that the page knows: it takes a position with an aim or a point to look at, and what it says itself.";

/** All numbers of a text. @param {string} text */
const numbersOf = (text) => (text.match(new RegExp(NUMBER, "gi")) ?? []).map(Number);

/** The longest text that is read. */
const LONGEST = 10_000;

/** A camera from text; an error says what is wrong. Whether its numbers make a camera the engine says. @param {string} text @param {number} rows of the picture, where the text has none @param {number} columns @param {number[]} up the scene's, where the text has none @returns {FlatCamera} */
export function parseCamera(text, rows, columns, up) {
    const trimmed = text.trim();
    if (trimmed.length > LONGEST) throw new Error(FAILURE);
    let camera;
    try {
        camera = trimmed.startsWith("{") ? ofMatrices(JSON.parse(trimmed), rows, columns) : ofText(trimmed, rows, columns, up);
    } catch (error) {
        throw error instanceof SyntaxError || error instanceof TypeError ? new Error(FAILURE) : error;
    }
    const numbers = [...camera.position, ...camera.aim, ...camera.up, camera.focal_length, camera.width, camera.height, camera.rows, camera.columns];
    if (!numbers.every(Number.isFinite)) throw new Error(FAILURE);
    return camera;
}

/** @param {string} text @param {number} rows @param {number} columns @param {number[]} up @returns {FlatCamera} */
function ofText(text, rows, columns, up) {
    if (/\bPINHOLE\b/.test(text)) return ofColmap(text);
    if (/\bCamera\s*\(/.test(text)) return ofPython(text);
    return ofNames(text, rows, columns, up);
}

/** Options of the command line, or a table of a scene file: names and what follows them. @param {string} text @param {number} rows @param {number} columns @param {number[]} usualUp @returns {FlatCamera} */
function ofNames(text, rows, columns, usualUp) {
    /** @param {string} name */
    const after = (name) => {
        const pattern = name.split("_").join("[-_]");
        const found = new RegExp(`(?:--|^\\s*)${pattern}(?:\\s*=\\s*|\\s+)(\\[[^\\]]*\\]|"[^"]*"|[^\\s]+)`, "im").exec(text);
        return found?.[1] ?? null;
    };
    /** @param {string} name @param {number} count */
    const numbers = (name, count) => {
        const found = numbersOf(after(name)?.replace(/(\d)x(\d|\.)/gi, "$1 $2") ?? "");
        return found.length === count ? found : null;
    };
    const [position, way, target, up] = ["position", "aim", "look_at", "up"].map((name) => numbers(name, 3));
    const aim = way ?? (position && target ? target.map((x, axis) => x - position[axis]) : null);
    /** Two numbers of one option, or of two keys. @param {string} option @param {string} one @param {string} other */
    const two = (option, one, other) => {
        const [first, second] = [numbers(one, 1), numbers(other, 1)];
        return numbers(option, 2) ?? (first && second ? [first[0], second[0]] : null);
    };
    const [plane, focal] = [two("viewplane", "width", "height"), numbers("focal_length", 1)];
    if (!position || !aim) throw new Error(FAILURE);
    const [wide, high] = two("size", "columns", "rows") ?? [columns, rows];
    if (/projection[\s="]+(?!perspective|orthographic\b)\w/.test(text)) throw new Error("The page has perspective and orthographic cameras alone.");
    const isParallel = /--orthographic\b|orthographic"/.test(text);
    const fov = numbers("fov", 1);
    const height = fov ? 2 * Math.tan((fov[0] * Math.PI) / 360) : 2 * Math.tan(Math.PI / 8);
    const [width, tall] = plane ?? [(height * wide) / high, height];
    return {
        position, aim, up: up ?? usualUp,
        projection: isParallel ? "orthographic" : "perspective",
        // As the command line has it: on the viewplane where one is given; in tables at the eye.
        ray_start: /viewplane/.test(after("ray_start") ?? (focal && text.includes("--") ? "viewplane" : "")) ? "viewplane" : "eye",
        focal_length: focal?.[0] ?? 1, width, height: tall, rows: high, columns: wide,
    };
}

/** A call of Python's. @param {string} text @returns {FlatCamera} */
function ofPython(text) {
    const call = text.slice(text.indexOf("("));
    const n = numbersOf(call);
    if (n.length < 14) throw new Error(FAILURE);
    return {
        position: n.slice(0, 3), aim: n.slice(3, 6), up: n.slice(6, 9),
        focal_length: n[9], width: n[10], height: n[11], rows: n[12], columns: n[13],
        projection: /orthographic/.test(call) ? "orthographic" : "perspective",
        ray_start: /["']eye["']/.test(call) ? "eye" : "viewplane",
    };
}

/** A camera in the axes right, down and forwards. @param {number[][]} rotation from the world @param {number[]} shift @param {number[]} focal lengths in pixels @param {number[]} middle in pixels, from the picture's corner @param {number} rows @param {number} columns @returns {FlatCamera} */
function ofPose(rotation, shift, focal, middle, rows, columns) {
    const isInTheMiddle = Math.abs(middle[0] - columns / 2) < 1e-6 * columns && Math.abs(middle[1] - rows / 2) < 1e-6 * rows;
    if (!isInTheMiddle) throw new Error("The page's camera has its principal point in the picture's middle; this one has not.");
    const position = [0, 1, 2].map((axis) => -rotation.reduce((sum, row, k) => sum + row[axis] * shift[k], 0));
    return {
        position, aim: rotation[2], up: rotation[1].map((x) => -x), projection: "perspective", ray_start: "eye",
        focal_length: 1, width: columns / focal[0], height: rows / focal[1], rows, columns,
    };
}

/** @param {any} given K and pose as OpenCV has them @param {number} rows @param {number} columns @returns {FlatCamera} */
function ofMatrices(given, rows, columns) {
    const { k, camera_from_world: pose, size } = given;
    if (!Array.isArray(k) || !Array.isArray(pose)) throw new Error(FAILURE);
    const [wide, high] = size ?? [columns, rows];
    if (Math.abs(k[0][1]) > 1e-9 * Math.abs(k[0][0])) throw new Error("The page's camera has no skew; this one has.");
    // The first pixel's centre is at 0.
    const middle = [k[0][2] + 0.5, k[1][2] + 0.5];
    const rotation = pose.slice(0, 3).map((/** @type {number[]} */ row) => row.slice(0, 3));
    return ofPose(rotation, pose.slice(0, 3).map((/** @type {number[]} */ row) => row[3]), [k[0][0], k[1][1]], middle, high, wide);
}

/** The lines of cameras.txt and images.txt. @param {string} text @returns {FlatCamera} */
function ofColmap(text) {
    const lines = text.split("\n").map((line) => line.trim()).filter((line) => line && !line.startsWith("#"));
    const camera = lines.find((line) => /\bPINHOLE\b/.test(line));
    const image = lines.find((line) => line !== camera);
    if (!camera || !image) throw new Error(FAILURE);
    const [wide, high, fx, fy, cx, cy] = numbersOf(camera.slice(camera.indexOf("PINHOLE")));
    const [, qw, qx, qy, qz, ...shift] = numbersOf(image);
    const rotation = [
        [1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qw * qz), 2 * (qx * qz + qw * qy)],
        [2 * (qx * qy + qw * qz), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qw * qx)],
        [2 * (qx * qz - qw * qy), 2 * (qy * qz + qw * qx), 1 - 2 * (qx * qx + qy * qy)],
    ];
    return ofPose(rotation, shift.slice(0, 3), [fx, fy], [cx, cy], high, wide);
}
