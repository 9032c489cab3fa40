// Which of many suspects shows in what a calibration has left over?
//
// Linear algebra on the whitened rows w and columns J of the best fit without any suspect, and on
// the columns X that every form of every suspect would add (at null, its amounts zero). What the
// geometry can absorb is nothing that could be seen, so it is projected out:
//     X~ = X - Q Q^T X,  Q an orthonormal basis of J (the priors' rows appended).
// With D the typical amounts and X~ D = U diag(s) V^T, z = U^T w: a form explains the chi-square
// gain |z|^2, which is chi-square distributed if it is not at work, and against amounts drawn from
// N(0, (c D)^2) it has the Bayes factor
//     ln B = 1/2 sum z^2 c^2 s^2 / (1 + c^2 s^2) - 1/2 sum ln(1 + c^2 s^2),
// averaged over several c since typical amounts are rough. What cannot be seen (s small) has B = 1:
// no evidence either way. Where the noise is not known the same is said in units of what is left.
//
// A form may act from one pose on ("onset"): then every change point is tried, at the cost of one.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

namespace talus {

// The best fit without suspects, made linear. The priors' rows, if any, stand last with pose -1.
struct Baseline {
  Eigen::VectorXd rows;
  Eigen::MatrixXd columns;
  std::vector<int> pose;    // of each row: 0, 1, ...
  std::vector<int> when;    // of each pose: its place in time, from 0 on; empty: as numbered. Poses
                            // of one place are not parted by a change point.
  bool noise_known = true;  // rows have unit variance; otherwise all have the same unknown one
  double taken = 0;  // rows' worth of freedom that is not in the rows: taken by unknowns already
                     // projected out, or rows that depend on others
};

// One way in which a suspect could be at work: an order, a driver, a covariate.
struct Form {
  int suspect = -1;          // the (effect, location) that it belongs to: 0, 1, ...
  std::vector<int> columns;  // of Candidates::columns: one for each amount
  bool onset = false;        // acts from one pose on
  std::vector<int> onsets;   // places in time where it may set in; empty: all but the first
  double weight = 1;         // its share among the forms of its suspect
};

struct Candidates {
  Eigen::MatrixXd columns;  // whitened; rows as of the baseline, without the priors'
  Eigen::VectorXd typical;  // prior standard deviation of the amount of each column
  std::vector<Form> forms;
};

// A form, and the place in time from which it acts (-1: it always does).
struct Pick {
  int form = -1;
  int from = -1;
  bool operator==(const Pick&) const = default;
};

struct Score {
  Pick pick;             // of a form with onset: the change point that explains most
  double gain = 0;       // chi-square explained, in units of the noise
  double all = 0;        // the same, with combinations too weak to be tested, by unit noise
  int freedom = 0;       // amounts (or combinations) that can be seen; 0: nothing can be said
  double log_p = 0;      // of the gain by chance, at this change point
  double log_bayes = 0;  // of a form with onset: averaged over its change points
  double visible = 0;    // |X~ D| / |X D|: what the geometry does not absorb
  double scale = 1;      // of the typical amounts: the one that the rows speak for most
  Eigen::VectorXd estimate, std;  // of the amounts, least squares in what can be seen
};

struct SuspectScore {
  int suspect = -1;
  double log_bayes = 0;  // averaged over its forms and change points
  Score best;            // the form with the largest Bayes factor
};

// A pose all of whose rows are freed, as if it were wrong.
struct PoseScore {
  int pose = -1;
  double gain = 0, freedom = 0, log_p = 0;
};

// Is the best of so many candidates better than chance makes the best of them? By parametric
// bootstrap for these very poses, over all forms and change points together.
struct Gate {
  bool open = false;         // family_p <= alpha
  double family_p = 1;       // of the best candidate, all tries taken into account
  double log_p = 0;          // smallest of all
  Pick best;                 // the one of the smallest p
  double threshold = 0;      // of log_p, at alpha; where nothing was drawn, as if tests were apart
  int tests = 0, draws = 0;  // draws are 0 where the answer was clear without
};

struct GateOptions {
  double alpha = 0.05;
  std::uint64_t seed = 1;
  int draws = 400;
  int threads = 1;
  bool studentised = false;  // judge by the noise that is left, even where it is stated
  bool always = false;       // draw even where the answer is clear (the threshold is wanted)
};

// What a rival, at its best, leaves of the signal of another candidate.
struct Rival {
  Pick pick;
  double left = 0;      // chi-square that it cannot imitate
  double imitates = 0;  // share of the signal that it does
};

struct ScreenOptions {
  int threads = 1;
  double least_visible = 0.05;  // a combination of amounts of typical size that moves the rows by
                                // fewer sigmas is not tested
  std::vector<double> scales = {0.3, 1, 3, 10};  // of the typical amounts, equally likely
  double reach = 10;  // amounts above this many typical ones are no way to imitate another
};

class Screen {
 public:
  Screen(Baseline baseline, Candidates candidates, const ScreenOptions& options = {});
  ~Screen();
  Screen(Screen&&) noexcept;
  Screen& operator=(Screen&&) noexcept;

  // Takes what the candidate can explain out of everything, as if it had been fitted.
  void accept(const Pick& pick);

  const Candidates& candidates() const;
  double freedom() const;  // rows less what has been fitted
  double chi2() const;     // of the rows, all that was accepted taken out

  Score score(const Pick& pick) const;
  // ln of Occam's factor where a fit found these amounts: with half the chi-square that they gained
  // it makes the Bayes factor, by Laplace's method. Never positive.
  double occam(const Pick& pick, const Eigen::VectorXd& amounts) const;
  std::vector<Score> scores() const;           // of each form
  std::vector<SuspectScore> suspects() const;  // best first
  std::vector<PoseScore> poses() const;        // of each recorded one, in order
  Gate gate(const GateOptions& options = {}) const;

  // What every form (at the change point that suits it best) leaves of the signal that the
  // candidate makes with these amounts; in the order of the forms.
  std::vector<Rival> rivals(const Pick& of, const Eigen::VectorXd& amounts) const;
  // The same for the signals of typical size, averaged over the directions of the amounts.
  std::vector<std::vector<Rival>> rivals(const std::vector<Pick>& of) const;
  // Candidates that no recording of these poses tells apart: all members of a class span the same
  // space once the geometry is projected out (smallest cosine above the given one). Indices into
  // `picks`; those that cannot be seen are in no class.
  std::vector<std::vector<int>> classes(const std::vector<Pick>& picks,
                                        double cosine = 0.995) const;
  // The signal's columns, projected and in units of the typical amounts: X~ D.
  Eigen::MatrixXd signal(const Pick& pick) const;

 public:
  struct Inside;  // of the implementation
  const Inside& inside() const { return *in_; }

 private:
  std::unique_ptr<Inside> in_;
};

}  // namespace talus
