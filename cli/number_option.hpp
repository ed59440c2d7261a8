// Numbers on the command line, as plans write them: 0.004, 4e-3 or 1/240.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace brickbench {

enum class Sign { positive, not_negative };

// An option that sets `value`, which must live as long as the verb. A text that is no such number
// is bad usage, and the message has it as typed.
CLI::Option* add_number(CLI::App& verb, const std::string& name, double& value,
                        const std::string& meaning, Sign sign);

// A value of --set that plans read: a number as it is, a fraction in quotes.
std::string set_value(const std::string& number);

}  // namespace brickbench
