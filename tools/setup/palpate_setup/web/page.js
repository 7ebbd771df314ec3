// Shows the steps, asks their questions, and follows the running step twice a second.
'use strict';

const token = new URLSearchParams(location.hash.slice(1)).get('token') || sessionStorage.getItem('token') || '';
sessionStorage.setItem('token', token);
history.replaceState(null, '', location.pathname);

const page = {state: null, chosen: null, asked: '', askedOf: '', order: 0};
window.palpateSetup = page;
const at = (id) => document.getElementById(id);

function request(path, body) {
  const options = {headers: {'X-Palpate-Token': token}};
  if (body !== undefined) Object.assign(options, {method: 'POST', body: JSON.stringify(body)});
  return fetch(path, options);
}

async function send(path, body) {
  const answer = await request(path, body);
  const content = await answer.json().catch(() => ({error: answer.statusText}));
  at('error').textContent = content.error || '';
  await follow();
}

function element(kind, properties, ...children) {
  const made = Object.assign(document.createElement(kind), properties);
  made.append(...children);
  return made;
}

function field(question) {
  const made = question.choices.length === 0 ?
      element('input', {name: question.key, value: question.default ?? '', autocomplete: 'off'}) :
      element('select', {name: question.key},
              ...question.choices.map((choice) => element('option', {value: choice, textContent: choice})));
  if (question.choices.length > 0 && question.default !== null) made.value = question.default;
  made.dataset.given = made.value;
  return made;
}

// Questions of the step, and those if it is skipped. What has been typed stays where a default changes.
function showQuestions(step) {
  const questions = [...(step.questions || [])];
  const known = new Set(questions.map((question) => question.key));
  for (const question of step.questions_to_skip || [])
    if (!known.has(question.key)) questions.push({...question, text: `(if skipped) ${question.text}`});
  const asked = JSON.stringify([step.name, questions.map((question) => [question.key, question.default])]);
  if (asked === page.asked) return;
  const typed = [...at('questions').elements].filter((input) => page.askedOf === step.name && input.value !== input.dataset.given);
  page.asked = asked;
  page.askedOf = step.name;
  at('questions').replaceChildren(...questions.flatMap((question) => [
    element('label', {}, question.text, element('small', {textContent: question.allowed})), field(question)]));
  for (const {name, value} of typed)
    if (at('questions').elements[name]) at('questions').elements[name].value = value;
  hideWhatDoesNotApply().catch((error) => { at('error').textContent = String(error); });
}

function typedAnswers(keys) {
  const answers = {};
  for (const input of at('questions').elements)
    if (keys.has(input.name)) answers[input.name] = input.value;
  return answers;
}

// Which questions apply depends on other answers; the program decides it.
async function hideWhatDoesNotApply() {
  const step = page.state.steps.find((one) => one.name === page.chosen);
  if (!step.questions) return;
  const keys = new Set([...step.questions, ...step.questions_to_skip].map((question) => question.key));
  const order = ++page.order;
  const answer = await request('/asked', {step: step.name, answers: typedAnswers(keys)});
  if (!answer.ok || order !== page.order) return;  // a later one is on its way
  const applies = new Set((await answer.json()).keys);
  for (const input of at('questions').elements)
    input.hidden = input.previousElementSibling.hidden = !applies.has(input.name);
}

async function showPictures(step) {
  const wanted = JSON.stringify([step.time, step.pictures]);
  if (at('pictures').dataset.shown === wanted) return;
  at('pictures').dataset.shown = wanted;
  const images = [];
  for (const name of step.pictures) {
    const answer = await request(`/file/${name}`);
    if (answer.ok) images.push(element('img', {src: URL.createObjectURL(await answer.blob()), alt: name}));
  }
  at('pictures').replaceChildren(...images);
}

function show() {
  const {state} = page;
  page.chosen = page.chosen || state.running ||
      (state.steps.find((step) => !['done', 'skipped'].includes(step.status)) || state.steps[0]).name;
  const step = state.steps.find((one) => one.name === page.chosen);
  at('project').textContent = state.project;
  at('steps').replaceChildren(...state.steps.map((one, i) => {
    const status = one.name === state.running ? 'running' : one.status;
    const button = element('button', {className: `${one.status} ${one === step ? 'chosen' : ''}`}, `${i + 1}. ${one.title}`,
                           element('small', {textContent: status}));
    button.dataset.step = one.name;
    button.onclick = () => { page.chosen = one.name; show(); };
    return button;
  }));
  at('title').textContent = step.title;
  at('about').textContent = step.about;
  at('why').textContent = step.missing.length ? `needs ${step.missing.join(', ')}` : step.why;
  showQuestions(step);
  const isBusy = state.running !== '';
  at('run').disabled = at('skip').disabled = isBusy || step.missing.length > 0;
  at('stop').hidden = !isBusy;
  at('waits').hidden = state.waits_for === '';
  at('waits-for').textContent = state.waits_for;
  at('log').textContent = isBusy || state.log.length ? state.log.join('\n') : '';
  at('lines').textContent = step.lines.join('\n');
  showPictures(step);
}

async function follow() {
  const answer = await request('/state');
  if (!answer.ok) {
    at('error').textContent = `${answer.status} ${answer.statusText}: open the address that palpate-setup has printed`;
    return;
  }
  page.state = await answer.json();
  show();
}

function run(skip) {
  const step = page.state.steps.find((one) => one.name === page.chosen);
  const keys = new Set((skip ? step.questions_to_skip : step.questions).map((question) => question.key));
  send('/run', {step: page.chosen, skip, answers: typedAnswers(keys)});
}

at('run').onclick = () => run(false);
at('skip').onclick = () => run(true);
at('stop').onclick = () => send('/stop', {});
at('continue').onclick = () => send('/continue', {});
at('questions').oninput = () => hideWhatDoesNotApply().catch((error) => { at('error').textContent = String(error); });
at('questions').onsubmit = (event) => event.preventDefault();
at('report').onclick = async () => {
  const answer = await request('/file/report.html');
  if (answer.ok) window.open(URL.createObjectURL(await answer.blob()));
};
setInterval(() => follow().catch((error) => { at('error').textContent = String(error); }), 500);
follow();
