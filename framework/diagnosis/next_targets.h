// What the poses to record next are for: to tell what was found from its rivals where the verdict
// is ambiguous, otherwise to show the usual suspects that the recordings at hand would not show.
#pragma once

#include <initializer_list>
#include <map>

#include "framework/diagnosis/advice.h"
#include "framework/diagnosis/pool.h"

namespace talus {

class NextTargets {
 public:
  // `mounting`: poses of the pool that are turned so may be chosen beside those that are not.
  NextTargets(const Diagnosis& diagnosis, const Seen& seen, const Pool& pool, int mounting);

  bool telling = false;
  std::vector<Target> wanted;
  std::vector<NextTarget> named;  // the same, in words
  NextPosesOptions needed;        // the chi-square by which a target is seen, and is told

  std::vector<std::size_t> which;  // of the pool's poses
  std::vector<PoolPose> poses;     // these
  Candidates candidates;           // of the pool, and what acts from a recorded pose on

  const Suspect& suspect(int form) const;  // a form of `candidates`

 private:
  void to_tell();
  void to_see();
  void target(const Suspect& suspect, const Way& way, const Eigen::VectorXd& amounts,
              const std::vector<const Accepted*>& rivals, const Accepted* found = nullptr);
  int form_of(const Suspect& suspect, const Way& way) const;
  int from_onset(int form, const Accepted& effect);

  const Diagnosis& d_;
  const Seen& seen_;
  const Pool& pool_;
  std::map<int, int> made_;  // a form that acts from a pose on, and the one it was made of
};

bool depends_on(const EffectTraits& effect, std::initializer_list<Covariate> any);
std::string place_of(const std::string& effect, const std::string& location);

}  // namespace talus
