// Foxglove's packages of package.json, and checks of messages by their schemas.

/** The named packages as one object of their exports; ends the program with 77 where one is missing. */
function load(...names) {
  try {
    return Object.assign({}, ...names.map((name) => require(name)));
  } catch (error) {
    console.error(`skipped: ${error.message.split('\n')[0]}; tools/packaging/install-foxglove installs them`);
    process.exit(77);
  }
}

/**
 * Checks of a channel's messages: by the schema that it states, and where it has the name of one of
 * Foxglove's by that. Each returns null, or what is wrong.
 */
function checksOf(name, text, problems) {
  const Ajv = require('ajv'), known = require('@foxglove/schemas/jsonschema');
  const ajv = new (Ajv.default || Ajv)({strict: false, allErrors: true, logger: false});
  const own = JSON.parse(text);
  if (own.type !== 'object') problems.push(`${name}: its schema is of a ${own.type}`);
  const schemas = [own];
  if (name.startsWith('foxglove.')) {
    const theirs = Object.values(known).find((schema) => schema && schema.title === name);
    if (theirs) schemas.push(theirs);
    else problems.push(`${name} is not among Foxglove's`);
  }
  return schemas.map((schema) => {
    const isValid = ajv.compile({...schema, $schema: undefined, $comment: undefined});
    return (message) => isValid(message) ? null : ajv.errorsText(isValid.errors);
  });
}

module.exports = {load, checksOf};
