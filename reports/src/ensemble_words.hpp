// What a verdict on a pair of ensembles says in words.
#pragma once

#include <string>
#include <string_view>

#include "reports/src/ensembles.hpp"

namespace brickbench {

// "identical", "same", "different", "open" or "not_tested": for columns and filters.
std::string_view to_word(EnsembleWord word);

// "bee/v", or "bee/v in after" where folders are compared.
std::string name_of(const EnsemblePair& pair, const StartSample& sample);

// Who differs from whom, named: "different: bee/v has more than ant/v (worse)".
std::string verdict_sentence(const EnsemblePair& pair);

// Whether the judged ensemble is different, and on the wrong side of the number's direction.
bool is_worse(const EnsemblePair& pair);

// "12", or "over 10000": more than that nobody runs.
std::string runs_wanted(std::size_t more);

// "5 %".
std::string percent_text(double share);

// "0.31 [0.29 .. 0.34]": the mean of the values, two or more, with its 95 % bootstrap interval.
std::string mean_text(const StartSample& sample);

}  // namespace brickbench
