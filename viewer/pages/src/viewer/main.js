// The live viewer: one connection feeds one world, which one view draws; the panel is for the hands.
//
//   messages.js    what travels          world.js    the map as three.js objects    panel.js     figures, buttons
//   connection.js  the line to kinloop   poses.js    keyframes, which glide         runState.js  what the run is doing
//   images.js      the camera's images   lines.js    frusta, paths, edges           keys.js      keys and their table
//   view.js        renderer, detail      models.js   meshes                         cut.js       what is cut off
//   cameraControls.js  viewpoint           floor.js    the grid                       drawer.js    the panel of a phone
//   framing.js     how large the map is                                             scaleBar.js  a length

import './viewer.css';
import { Connection } from './connection.js';
import { Images } from './images.js';
import { Panel } from './panel.js';
import { View } from './view.js';
import { World } from './world.js';

const world = new World();
const view = new View(document.getElementById('scene'), world);
const images = new Images(document.getElementById('images'));
const connection = new Connection({ onMessage: onMessage, onChange: (connected) => panel.state.setConnected(connected) });
const panel = new Panel({ world, view, connection });
world.onProblem = (text) => panel.state.showProblem(text);
let run;
let loops = 0;

function onMessage(message) {
  if (message.kind === 'hello') onHello(message.body);
  if (message.kind === 'status') panel.state.show(message.body);
  if (message.kind === 'loops') showLoopBanner(message.body.length / 2);
  world.take(message);
  images.take(message);
}

function onHello(hello) {
  if (run !== hello.run) {
    world.clear(); // another run than the one before the line broke
    view.cameraControls.touched = false;
    panel.cut.set(Infinity);
    loops = 0;
  }
  run = hello.run;
  panel.greet(hello);
}

function showLoopBanner(count) {
  if (count > loops && world.pieces.size > 0) panel.flash(count === 1 ? 'loop closed' : `loop ${count} closed`);
  loops = count;
}

// For tests and measurements: what is there to see.
window.kinloop = { world, view, connection };
