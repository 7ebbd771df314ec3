// Resolution of the image: full while it rests, and while it moves as high as the machine can draw
// fluently.

const SLOW = 36, FAST = 22;  // ms between the browser's frames
const STEP = 0.75, LEAST = 0.5;
const RESTS_AFTER = 400, JUDGED_AFTER = 1500, AGAIN_AFTER = 20000;  // ms

export class Pace {
  constructor() {
    this.interval = 1000 / 60;  // ms, low-pass filtered
    this.moving = 1;  // sharpness during motion
    this.last = this.changed = this.movedAt = -1e9;
    this.notBefore = 0;  // times at which less, or more, may be tried
    this.before = null;  // {sharpness, interval} before the last step
  }

  /** Reports a visible change of the image. */
  moved(now) { this.movedAt = now; }

  /** Call in each of the browser's frames; `drew`: whether the previous one was drawn. Sharpness, 0.5 to 1. */
  next(now, drew) {
    const taken = now - this.last;
    this.last = now;
    if (now - this.movedAt > RESTS_AFTER) return 1;
    // A browser that was suspended was not slow.
    if (drew && taken < 1000) this.interval += 0.1 * (taken - this.interval);
    if (now - this.changed > JUDGED_AFTER && now > this.notBefore) this.judge(now);
    return this.moving;
  }

  judge(now) {
    const {before} = this;
    this.before = null;
    if (before && before.sharpness > this.moving && this.interval > 0.9 * before.interval) {
      // The time is spent elsewhere: a blurred image would not help.
      this.moving = before.sharpness;
      this.notBefore = now + AGAIN_AFTER;
    } else if (this.interval > SLOW && this.moving > LEAST) {
      this.set(Math.max(this.moving * STEP, LEAST), now);
    } else if (this.interval < FAST && this.moving < 1) {
      this.set(Math.min(this.moving / STEP, 1), now);
      this.notBefore = now + AGAIN_AFTER;
    }
  }

  set(sharpness, now) {
    this.before = {sharpness: this.moving, interval: this.interval};
    this.moving = sharpness;
    this.changed = now;
  }
}
