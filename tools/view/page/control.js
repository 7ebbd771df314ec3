// Commands: buttons, components, and their results.

const byId = (id) => document.getElementById(id);

export class Control {
  constructor(send) {
    this.send = send;
    this.granted = false;
    this.next = 1;
    this.asked = new Map();
    this.configured = [];
    for (const button of document.querySelectorAll('#commands button'))
      button.onclick = () => this.command({event: button.dataset.event}, button.dataset.event);
    byId('strength').oninput = () => this.showStrength();
    this.showStrength();
  }

  /** N per m of pull. */
  get strength() { return 10 ** Number(byId('strength').value) * 10; }
  showStrength() { byId('strength-now').textContent = `${Number((this.strength / 10).toPrecision(2))} N`; }

  setHello(hello) {
    this.slots = hello.slots;
    this.configured = hello.configured.map((one) => ({...one, chosen: {...one.chosen}}));
    this.offered = hello.control;
    this.setGranted(false, '');
    byId('control-tab').hidden = hello.mode === 'log';
  }

  setGranted(granted, reason) {
    this.granted = granted;
    byId('commands').hidden = !granted;
    byId('pointer').hidden = !granted;
    byId('control-body').hidden = !granted;
    byId('control-note').hidden = granted;
    byId('control-note').textContent = reason ? `${reason}: reading only.` : !this.offered
        ? 'Reading only. palpate-view --control lets this page command the daemon.'
        : 'Reading only. To command, open the address with its token that palpate-view printed.';
    if (granted) this.showSlots();
  }

  /** Replacements reported by the daemon. */
  note(event) {
    if (event.event !== 'replaced' || !event.component) return;
    const one = this.configured.find((c) => c.slot === event.slot && (!event.instance || c.instance === event.instance));
    const slot = this.slots && this.slots.find((s) => s.slot === event.slot);
    if (!one || !slot) return;
    one.chosen[slot.choices[0].key] = event.component;
    if (this.granted) this.showSlots();
  }

  showSlots() {
    const grid = byId('slots');
    grid.textContent = '';
    if (!this.configured.length) {
      const note = document.createElement('span');
      note.className = 'quiet';
      note.textContent = 'Which components there are says --config.';
      note.style.gridColumn = '1 / -1';
      grid.append(note);
    }
    for (const one of this.configured) {
      const slot = this.slots.find((s) => s.slot === one.slot);
      for (const {key, names} of slot.choices) {
        const label = document.createElement('span'), select = document.createElement('select'), apply = document.createElement('button');
        label.className = 'name';
        label.textContent = one.instance ? `${one.slot} ${one.instance}` : slot.choices.length > 1 ? key : one.slot;
        for (const name of names) select.add(new Option(name, name, false, name === one.chosen[key]));
        select.dataset.slot = one.slot;
        select.dataset.instance = one.instance;
        select.dataset.key = key;
        apply.textContent = 'Put in';
        apply.dataset.slot = one.slot;
        apply.dataset.instance = one.instance;
        apply.onclick = () => this.replace(one, key, select.value);
        grid.append(label, select, apply);
      }
    }
  }

  replace(one, key, name) {
    const typed = byId('parameters').value.trim();
    const command = {event: 'replace', slot: one.slot, instance: one.instance};
    if (key === 'component') {
      command.component = name;
      if (typed) command.parameters = typed;
    } else {
      const inner = typed.replace(/^\{|\}$/g, '').trim();
      command.parameters = `{${key}: ${name}${inner ? `, ${inner}` : ''}}`;
    }
    this.command(command, `${one.slot} ${one.instance}: ${name}`.replace(' :', ':'),
                 (good) => {
                   if (good) one.chosen[key] = name;
                   this.showSlots();  // if it was rejected, the available ones
                 });
  }

  command(command, what, done) { this.ask({type: 'command', ...command}, what, done); }

  ask(message, what, done) {
    const id = this.next++;
    const item = document.createElement('li'), name = document.createElement('b'), said = document.createElement('div');
    name.textContent = what;
    said.textContent = '\u2026';
    item.append(name, said);
    byId('answers').prepend(item);
    while (byId('answers').childElementCount > 50) byId('answers').lastChild.remove();
    this.asked.set(id, {item, said, done});
    if (!this.send({...message, id})) this.answer({id, event: '', reason: 'not connected', last: true});
  }

  answer({id, event, reason, last}) {
    const asked = this.asked.get(id);
    if (!asked) return;
    asked.said.textContent = [event, reason].filter(Boolean).join(': ');
    const good = event && event !== 'refused';
    asked.item.className = !last ? 'warn' : good ? 'good' : 'bad';
    if (!last) return;
    this.asked.delete(id);
    if (!good) byId('reason').textContent = asked.said.textContent;
    if (asked.done) asked.done(good);
  }

  fail(reason) {
    for (const [id] of this.asked) this.answer({id, event: '', reason, last: true});
  }
}
