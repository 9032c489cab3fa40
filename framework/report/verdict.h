// The verdict of a command in words, figures of rows held out first: what its report opens with, as
// text and as a page alike.
//
//     CALIBRATED. The stated noise explains what the fit leaves.
//       On 20 poses held out, residuals are 1.09 times the stated noise ...
//
// "Times the stated noise" has one meaning: the root mean square of residuals divided by their
// sigmas, divided by what is expected where the stated noise is all there is. On fitted rows that
// is the square root of chi-square per degree of freedom.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/report/axes.h"
#include "framework/report/report.h"

namespace talus {

enum class Mood { good, doubtful, bad };

struct Spoken {
  std::string word;      // "CALIBRATED": one of a few
  std::string headline;  // a sentence without its full stop
  std::vector<std::string> sentences;
};

std::optional<Mood> mood_of(const std::string& word);  // of all words that verdicts have

Spoken verdict_of_model(const Program& program);
// Recordings with it: `poses` rows, of which `missing` residuals lack a value.
Spoken verdict_of_check(const Program& program, std::size_t poses, std::size_t missing,
                        const Identifiability& seen);
Spoken verdict_of_fit(const Program& program, const Fit& fit);
Spoken verdict_of_axes(const AxesResult& result, const std::vector<std::string>& names);

std::string noise_in_words(const Fit& fit);  // "1.02 times the stated noise", of the rows fitted

std::string text_of(const Spoken& verdict);

}  // namespace talus
