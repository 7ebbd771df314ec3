#include <algorithm>
#include <cmath>

#include "tools/doctor/checks.hpp"

namespace palpate::doctor {
namespace {

/// Version of a Debian package; empty if it is not installed.
std::string package_version(const Machine& machine, const std::string& package) {
  bool within = false, installed = false;
  for (const std::string& line : machine.lines("var/lib/dpkg/status")) {
    if (line.empty()) {
      within = installed = false;
    } else if (line == "Package: " + package) {
      within = true;
    } else if (within && line == "Status: install ok installed") {
      installed = true;
    } else if (within && installed && line.rfind("Version: ", 0) == 0) {
      return line.substr(9);
    }
  }
  return "";
}

Finding check_lcm(const Machine& machine) {
  const std::string version = package_version(machine, "liblcm1");
  if (version.empty()) {
    for (const char* folder :
         {"usr/lib/x86_64-linux-gnu", "usr/lib/aarch64-linux-gnu", "usr/lib", "usr/local/lib"}) {
      if (machine.exists(std::string(folder) + "/liblcm.so.1"))
        return ok("lcm", "/" + std::string(folder) + "/liblcm.so.1, of unknown version");
    }
    return fail("lcm", "liblcm is not installed", "nothing can be published",
                "sudo apt-get install liblcm1 liblcm-bin");
  }
  const bool is_tried = version.rfind("1.3.", 0) == 0 || version.rfind("1.4.", 0) == 0 ||
                        version.rfind("1.5.", 0) == 0;
  if (is_tried) return ok("lcm", "liblcm " + version);
  return warn("lcm", "liblcm " + version, "palpate has been tried with 1.3.1 alone",
              "sudo apt-get install liblcm1=1.3.1+repack1-3");
}

Finding check_spy(const Machine& machine, const std::string& spy_jar) {
  const auto lacks = [](const std::string& what, const std::string& package) {
    return warn("spy", what, "palpate-spy cannot start", "sudo apt-get install " + package);
  };
  const std::optional<std::string> java = machine.resolve("usr/bin/java");
  if (!java) return lacks("Java is not installed", "default-jre");
  const std::filesystem::path home = std::filesystem::path(*java).parent_path().parent_path();
  if (!machine.exists((home / "lib/libawt_xawt.so").string()))
    return lacks("this Java has no windows (headless)", "default-jre");
  if (!machine.exists("usr/share/java/lcm.jar")) return lacks("lcm.jar is missing", "liblcm-java");
  if (!machine.exists("usr/share/java/jchart2d.jar"))
    return lacks("jchart2d.jar is missing", "libjchart2d-java");
  if (!machine.exists(spy_jar))
    return warn("spy", "/" + spy_jar + " is missing", "palpate-spy cannot start",
                "cmake --build build/release --target palpate-spy");
  std::string version;
  for (const std::string& line : machine.lines((home / "release").string())) {
    if (line.rfind("JAVA_VERSION=", 0) == 0) version = " " + line.substr(13);
  }
  version.erase(std::remove(version.begin(), version.end(), '"'), version.end());
  return ok("spy", "Java" + version + ", its jars are there");
}

/// The BLAS by which CHOLMOD factors in the background.
Finding check_blas(const Machine& machine) {
#ifdef PALPATE_SUITESPARSE
  constexpr const char* kInstall = "sudo apt-get install libopenblas0-pthread";
  for (const std::string folder : {"usr/lib/x86_64-linux-gnu", "usr/lib/aarch64-linux-gnu"}) {
    const std::optional<std::string> file = machine.resolve(folder + "/libblas.so.3");
    if (!file) continue;
    const std::string found = "/" + *file;
    if (file->find("openblas-pthread") != std::string::npos) return ok("blas", found);
    const std::string select = std::string(kInstall) +
                               "\nsudo update-alternatives --set libblas.so.3-" + folder.substr(8) +
                               " /" + folder + "/openblas-pthread/libblas.so.3";
    if (file->find("openblas-serial") != std::string::npos)
      return fail("blas", found,
                  "not thread-safe, results may be wrong: palpated does not start "
                  "unless deformation.factor is own",
                  select);
    for (const char* parallel : {"pthread", "openmp"}) {
      if (file->find(parallel) != std::string::npos)
        return fail("blas", found,
                    "its threads take the loop's processors: palpated does not start unless "
                    "deformation.factor is own",
                    select);
    }
    return warn("blas", found, "slow: factors take twice as long or longer", select);
  }
  return fail("blas", "libblas.so.3 is not installed", "palpated cannot be loaded", kInstall);
#else
  static_cast<void>(machine);
  return ok("blas", "not used: palpated is built without SuiteSparse");
#endif
}

}  // namespace

Findings check_programs(const Machine& machine, const std::string& spy_jar) {
  return {check_lcm(machine), check_blas(machine), check_spy(machine, spy_jar)};
}

Findings check_disk(const Needs& needs, const record::FreeSpace& free_space) {
  constexpr double kMegabyte = 1e6;
  constexpr double kRate = 6;  // MB/s of control and housekeeping at 1 kHz
  double free = 0;
  try {
    free = static_cast<double>(free_space(needs.record_folder)) / kMegabyte;
  } catch (const std::exception& error) {
    return {fail("disk", error.what(), "neither logs nor records can be written",
                 "mkdir -p '" + needs.record_folder + "'")};
  }
  const std::string text = std::to_string(std::llround(free)) + " MB free in " +
                           needs.record_folder + ", a log of " +
                           std::to_string(std::llround(free / kRate / 60)) + " minutes";
  const std::string remedy =
      "df -h '" + needs.record_folder + "'   # make room, or record with --split-mb and --rotate";
  if (free < 200) return {fail("disk", text, "palpate-record does not begin", remedy)};
  if (free < 2000) return {warn("disk", text, "a recording ends early", remedy)};
  return {ok("disk", text)};
}

}  // namespace palpate::doctor
