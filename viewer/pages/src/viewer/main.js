// The live viewer: one connection, or the recording in a shared page, feeds one world, which one view draws; the panel
// holds the controls.
//
//   messages.js    the protocol          world.js    the map as three.js objects    panel.js     figures, buttons
//   connection.js  the connection        poses.js    keyframe poses, animated       runState.js  state of the run
//   images.js      the camera's images   lines.js    frusta, paths, edges           keys.js      keys and their table
//   view.js        renderer, detail      models.js   meshes; meshPiece.js: live     cut.js       cutting height
//   cameraControls.js  viewpoint         floor.js    the grid                       drawer.js    the panel of a phone
//   framing.js     extent of the map     interior.js  the view from inside a room   scaleBar.js  a length
//   eyeDome.js     shading               timeline.js  replay of saved runs          theme.js     light or dark
//   keyframePictures.js  images in 3D    timelineBar.js  its drawing; track.js: a run  clipBox.js   clipping to a box
//   shownCamera.js  a camera in 3D
//   picking.js     what a click hits     measures.js  distances, angles, heights    picked.js    what a click shows
//   recording.js   the map in the page   loops.js      loops of a saved run        comparison.js  of two maps
//   selectList.js  a list to select from  elements.js  parts of the page made here

import './viewer.css';
import { Connection } from './connection.js';
import { Images } from './images.js';
import { Panel } from './panel.js';
import { Recording } from './recording.js';
import { Timeline } from './timeline.js';
import { View } from './view.js';
import { World } from './world.js';

const world = new World();
const view = new View(document.getElementById('scene'), world);
const images = new Images(document.getElementById('images'));
const timeline = new Timeline({ world, view, images });
const recording = document.getElementById('recording').textContent;
const listener = {
  onMessage,
  onChange: (connected) => panel.state.setConnected(connected),
  onRefused: (reason) => {
    panel.state.refuseControl(reason);
    panel.loops.refuse(reason);
  },
  onProblem: (text) => panel.state.showProblem(text),
};
const connection = recording ? new Recording(recording, listener) : new Connection(listener);
const panel = new Panel({ world, view, connection, timeline });
world.onProblem = (text) => panel.state.showProblem(text);
let run;
let loops = 0;

function onMessage(message) {
  if (message.kind === 'hello') onHello(message.body);
  if (message.kind === 'status') panel.state.show(message.body);
  if (message.kind === 'status') panel.loops.setBusy(message.body.busy ?? false);
  if (message.kind === 'loops') showLoopBanner(message.body.length / 2);
  world.take(message);
  if (message.kind === 'timeline') timeline.take(message.body, message.index);
  if (message.kind === 'timeline' || message.kind === 'loops') timeline.markLoops();
  if (message.kind === 'loopTable') panel.loops.take(message.body);
  if (message.kind === 'comparison') panel.comparison.take(message.body);
  if (message.kind === 'comparison') timeline.name(message.body.names);
  if (message.kind === 'timeline') panel.loops.show(); // times are since its start
  images.take(message);
}

function onHello(hello) {
  if (run !== hello.run) {
    world.clear(); // a different run than before the interruption
    timeline.clear();
    view.cameraControls.touched = false;
    panel.cut.set(Infinity);
    panel.clear();
    panel.loops.clear();
    panel.comparison.clear();
    loops = 0;
  }
  run = hello.run;
  panel.greet(hello);
}

function showLoopBanner(count) {
  if (count > loops && world.pieces.size > 0) panel.flash(count === 1 ? 'loop closed' : `loop ${count} closed`);
  loops = count;
}

// For tests and measurements.
window.kinloop = { world, view, connection, timeline, panel };
