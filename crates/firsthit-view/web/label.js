// @ts-check
// Words on a picture: on a ground of their own, so that they can be read on every colour.

/** The same in light and in dark pages, since the picture behind is. */
export const MARK = "#ffd166";
const GROUND = "#10151be6";
const INK = "#ffffff";
const FONT = "system-ui, sans-serif";

/** Writes a text beside a point; `x_c` is a letter with a subscript. @param {CanvasRenderingContext2D} on @param {string} text @param {[number, number]} place */
export function label(on, text, [x, y]) {
    const [, letter, below] = text.match(/^([a-z])_(\w+)$/) ?? ["", text, ""];
    on.save();
    on.textBaseline = "middle";
    const fonts = [`${below ? "italic " : ""}13px ${FONT}`, `italic 10px ${FONT}`];
    const widths = [letter, below].map((part, k) => {
        on.font = fonts[k];
        return on.measureText(part).width;
    });
    const width = widths[0] + widths[1] + 8;
    // Inside the picture, and beside the point.
    const { width: columns } = on.canvas;
    const scale = on.getTransform().a;
    const left = x + 8 + width > columns / scale ? x - 8 - width : x + 8;
    const middle = Math.max(10, y - 10);
    on.fillStyle = GROUND;
    on.beginPath();
    on.roundRect(left, middle - 10, width, 20, 4);
    on.fill();
    on.fillStyle = INK;
    on.font = fonts[0];
    on.fillText(letter, left + 4, middle);
    on.font = fonts[1];
    on.fillText(below, left + 4 + widths[0], middle + 4);
    on.restore();
}

/** Draws a line that is seen on every colour: bright, with dark edges. @param {CanvasRenderingContext2D} on @param {string} color @param {number} width */
export function strokeOutlined(on, color, width) {
    on.lineWidth = width + 2;
    on.strokeStyle = GROUND;
    on.stroke();
    on.lineWidth = width;
    on.strokeStyle = color;
    on.stroke();
}
