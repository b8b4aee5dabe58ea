// The report of one run, or of several side by side. Its data are embedded in the page by kinloop
// (viewer/report/report.cpp); every section is a function of the runs that returns its element, or nothing if
// there is nothing to show.
//
//   summary.js  figures and comparison     tracking.js  features, inliers, time per frame     pictures.js  map, loops
//   paths.js    top and side view          modules.js   CPU time per module                   details.js   options ...
//   errors.js   over time, histogram       cloud.js     3D map
//
//   plot.js     style of all plots         page.js      style of all sections                 doubt.js    verdict, shades

import './report.css';
import { cloudSection } from './cloud.js';
import { detailsSection } from './details.js';
import { errorSection } from './errors.js';
import { moduleSection } from './modules.js';
import { element, problem } from './page.js';
import { pathSection } from './paths.js';
import { loopSection, mapSection } from './pictures.js';
import { headSection, summarySection } from './summary.js';
import { trackingSection } from './tracking.js';

const SECTIONS = [
  headSection,
  summarySection,
  mapSection,
  cloudSection,
  pathSection,
  errorSection,
  loopSection,
  trackingSection,
  moduleSection,
  detailsSection,
];

const { runs } = JSON.parse(document.getElementById('data').textContent);
runs.forEach((run, index) => (run.color = `var(--run${index % 6})`));
document.title = `${runs.map((run) => run.name).join(', ')} - kinloop`;
const main = document.querySelector('main');
if (runs.length === 0) main.append(element('p', {}, 'No runs.'));
else main.append(...SECTIONS.map(made).filter(Boolean));

/** A section that fails leaves the others as they are. */
function made(section) {
  try {
    return section(runs);
  } catch (error) {
    return problem('A section', error);
  }
}
