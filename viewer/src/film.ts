// SPDX-License-Identifier: Apache-2.0

/** Every picture of the flight as one film; picture i stands from i / rate to (i + 1) / rate. */
export class Film {
  /** The picture on `canvas`; -1: none yet. */
  shown = -1;
  failed = false;
  readonly canvas = document.createElement("canvas");
  private wanted = -1;
  private busy = false;
  private readonly video = document.createElement("video");

  /** @param size of a picture in the film; its even sides may be one pixel longer [px] */
  constructor(base64: string, private readonly rate: number, size: [number, number], private readonly onPicture: () => void) {
    const letters = atob(base64), bytes = new Uint8Array(letters.length);
    for (let i = 0; i < bytes.length; ++i) bytes[i] = letters.charCodeAt(i);
    [this.canvas.width, this.canvas.height] = size;
    this.canvas.getContext("2d")!.imageSmoothingEnabled = false;
    this.video.muted = true;
    this.video.playsInline = true;
    this.video.preload = "auto";
    this.video.addEventListener("loadeddata", () => this.next());
    this.video.addEventListener("error", () => { this.failed = true; onPicture(); });
    // Then the frame at currentTime is there to be drawn; a test compares pixels.
    this.video.addEventListener("seeked", () => this.take());
    this.video.src = URL.createObjectURL(new Blob([bytes], { type: "video/webm" }));
  }

  want(picture: number): void {
    this.wanted = picture;
    this.next();
  }

  /** One jump at a time: who scrubs fast sees what is ready, then what was wanted last. */
  private next(): void {
    if (this.busy || this.wanted < 0 || this.wanted === this.shown || this.video.readyState < HTMLMediaElement.HAVE_METADATA) return;
    this.busy = true;
    this.video.currentTime = (this.wanted + 0.5) / this.rate;
  }

  private take(): void {
    this.busy = false;
    this.shown = Math.floor(this.video.currentTime * this.rate);
    this.canvas.getContext("2d")!.drawImage(this.video, 0, 0);
    this.onPicture();
    this.next();
  }
}
