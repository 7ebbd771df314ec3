# Files that every Debian package has, from LICENSE and the templates in this folder. palpate_debian is this
# folder, palpate_licence the file LICENSE; palpate_version and palpate_maintainer are for the changelog.
function(palpate_write_copyright file)
  file(READ "${palpate_licence}" text)
  string(REGEX REPLACE "\n\n" "\n.\n" text "${text}")
  string(REGEX REPLACE "\n" "\n " text "${text}")
  string(STRIP "${text}" text)
  file(READ "${palpate_debian}/copyright" head)
  file(WRITE "${file}" "${head} ${text}\n")
endfunction()

function(palpate_write_changelog file)
  file(READ "${palpate_debian}/changelog" text)
  string(REPLACE "@VERSION@" "${palpate_version}" text "${text}")
  string(REPLACE "@MAINTAINER@" "${palpate_maintainer}" text "${text}")
  file(WRITE "${file}" "${text}")
endfunction()
