// Browser: a headless Chromium that is driven through a pipe, in the Chrome DevTools Protocol.
#pragma once

#include <sys/types.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "adapters/seam/failure.hpp"

namespace brickbench {

class Browser {
 public:
  // Starts `program` with software GL and a profile folder of its own; without its sandbox where
  // that is refused, and says so. Fault::crashed if it does not answer.
  static Expected<std::unique_ptr<Browser>> start(const std::string& program);
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  // Opens the file in a window of this size and waits until window.brickbench is there.
  Expected<void> open(const std::string& file, int width_px, int height_px);

  // The value of a JavaScript expression; promises are awaited. Fault::crashed with the page's
  // message if it throws.
  Expected<nlohmann::json> evaluate(const std::string& expression);

 private:
  Browser() = default;
  static Expected<std::unique_ptr<Browser>> start(const std::string& program, bool sandbox);
  Expected<nlohmann::json> call(const std::string& method, const nlohmann::json& parameters);
  Expected<nlohmann::json> receive();

  pid_t process_ = -1;
  int to_ = -1;
  int from_ = -1;
  int next_id_ = 1;
  std::string session_;
  std::string profile_;
  std::string buffer_;
};

}  // namespace brickbench
