// @ts-check
// The mouse, the pen and fingers on the picture.

/** @typedef {{moved: () => void, point: (event: PointerEvent) => void, keep: (event: PointerEvent) => void}} Acts */

/** Less than so many pixels is no drag. */
const CLICK = 4;

/** Moves the camera by dragging, pinching and the wheel; what only points is told. @param {HTMLCanvasElement} picture @param {import("./camera.js").OrbitCamera} camera @param {Acts} acts */
export function controlCamera(picture, camera, acts) {
    /** @type {Map<number, PointerEvent>} */
    const held = new Map();
    let way = 0;
    picture.addEventListener("contextmenu", (event) => event.preventDefault());
    picture.addEventListener("pointerdown", (event) => {
        picture.setPointerCapture(event.pointerId);
        if (held.size === 0) way = 0;
        held.set(event.pointerId, event);
    });
    picture.addEventListener("pointermove", (event) => {
        const before = held.get(event.pointerId);
        if (!before) {
            acts.point(event);
            return;
        }
        const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
        const others = [...held.values()].filter((other) => other.pointerId !== event.pointerId);
        held.set(event.pointerId, event);
        way += Math.abs(dx) + Math.abs(dy);
        if (way < CLICK) return;
        const edge = picture.clientHeight;
        if (others.length > 0) {
            // Two fingers: their middle moves the camera, and their distance brings it nearer.
            const apart = (/** @type {PointerEvent} */ one) => Math.hypot(one.clientX - others[0].clientX, one.clientY - others[0].clientY);
            camera.pan(dx / 2 / edge, dy / 2 / edge);
            camera.zoom(apart(before) / Math.max(1, apart(event)), 0, 0);
        } else if (event.shiftKey || (event.buttons & 6) !== 0) {
            camera.pan(dx / edge, dy / edge);
        } else {
            camera.orbit((Math.PI * dx) / edge, (Math.PI * dy) / edge);
        }
        acts.moved();
    });
    const release = (/** @type {PointerEvent} */ event) => {
        const isClick = held.delete(event.pointerId) && held.size === 0 && way < CLICK;
        if (isClick && event.type === "pointerup" && event.button === 0) acts.keep(event);
    };
    picture.addEventListener("pointerup", release);
    picture.addEventListener("pointercancel", release);
    picture.addEventListener(
        "wheel",
        (event) => {
            event.preventDefault();
            const box = picture.getBoundingClientRect();
            const x = (event.clientX - box.left - box.width / 2) / box.height;
            const y = -(event.clientY - box.top - box.height / 2) / box.height;
            const pixels = event.deltaMode === 1 ? 16 * event.deltaY : event.deltaY;
            camera.zoom(Math.exp(0.0015 * pixels), x, y);
            acts.moved();
        },
        { passive: false },
    );
}
