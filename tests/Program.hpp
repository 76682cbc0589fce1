// Running a program as a user does: in a directory, with its words on both streams and its exit code.
#pragma once
#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "Scratch.hpp"

struct Outcome {
  int code;
  std::string out, err;
};

/// Runs a shell command in a directory; the streams are kept outside of it.
inline Outcome runIn(const std::filesystem::path& directory, const std::string& command) {
  const Scratch streams;
  const int status = std::system(("cd '" + directory.string() + "' && " + command + " >'" +
                                  (streams / "out").string() + "' 2>'" +
                                  (streams / "err").string() + "' </dev/null")
                                     .c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(streams / "out"),
          contents(streams / "err")};
}

#ifdef MALUS_PROGRAM
inline Outcome malusIn(const std::filesystem::path& directory, const std::string& arguments,
                       const std::string& environment = "") {
  return runIn(directory, environment + " '" MALUS_PROGRAM "' " + arguments);
}
#endif
