// Starts the viewer; without WebGL 2 the picture that stands in the page stays.

async function start() {
  const { scene, blob } = await unpack();
  const canvas = document.getElementById("stage");
  const motions = scene.motions.map((entry) => new Motion(blob, entry, scene.bodies.length));
  const renderer = new Renderer(canvas, scene, blob);
  const controls = new Controls(new State(scene, motions), renderer);
  canvas.addEventListener("webglcontextlost", () => { document.body.dataset.viewer = "lost"; });
  controls.state.camera.aspect = renderer.resize();
  controls.reframe();
  controls.paint();
  performance.mark("viewer ready");
  follow(controls);
  document.body.dataset.viewer = "ready";
  return controls;
}

start().then((controls) => { window.kinformViewer = controls; }, (error) => {
  document.body.dataset.viewer = "none";
  document.getElementById("viewer-fault").textContent = `No interactive view: ${error.message}. The picture shows the assembly.`;
});
