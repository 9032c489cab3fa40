// Effects: what an ideal linkage leaves out. An effect is a small correction at a named place of
// the model; its amounts are zero where nothing is wrong, so that the ideal model is the extended
// one with all amounts at zero, and a hypothesis is a few more columns of the Jacobian.
//
//     struct EncoderEccentricity {
//       static Declaration declaration() {
//         return effect("encoder_eccentricity", Acts::reading, "scale off its centre ...")
//             .on(angle)
//             .amount("sine", angle, 0.1 * deg, "part in phase with the reading")
//             .amount("cosine", angle, 0.1 * deg, "part a quarter turn ahead")
//             .shown(phasor("amplitude", "phase", "sine", "cosine"));
//       }
//       template <class T>
//       static T act(const Around<T>& around, T sine, T cosine) {
//         return sine * sin(around.reading) + cosine * cos(around.reading);
//       }
//     };
//     TALUS_PLUGIN(EncoderEccentricity)
//
// In a model file: <encoder_eccentricity at="encoder3" sine="0 ± 0.1" cosine="0 ± 0.1"/>.
// Where it acts (Acts) says what `act` returns: one number, a small motion (Twist), or a
// deformation. Several effects at one place add up.
#pragma once

#include <string>
#include <vector>

#include "framework/kinematics/rigid.h"
#include "framework/model/units.h"

namespace talus {

enum class Acts {
  reading,     // T: added to a sensor's reading
  coordinate,  // T: added to a joint's coordinate
  axis,        // Twist: in the joint's axis frame (z along the axis), before the joint moves
  about,       // Twist D: the moving part M of the joint becomes D M D^-1: its axis is displaced
  link,        // Twist: in the frame behind the joint, at the link's end
  lengths,     // T: all lengths of the joints' transforms are multiplied by 1 + T
  fixture,     // Twist: in the frame in which features are measured, before everything else
  tip,         // Twist: in the measured frame, behind everything else
  measured     // Matrix3 D: measured coordinates p become (1 + D) p
};
std::string to_string(Acts acts);
int parts_of(Acts acts);  // how many numbers: 1, 6 (translation, rotation) or 9 (rows of D)

// What an effect may depend on. All but the first group are columns of the recordings, or follow
// from them.
enum class Covariate {
  approach,     // -1, 0, +1: sense in which the joint was last moved; approach_<joint>
  time,         // s
  session,      // number of the session
  pose,         // number in the order of recording
  temperature,  // degC
  rate,         // of the reading: difference quotient over the neighbouring rows of its session
  travel,       // of the reading since its last reversal, absolute
  since,        // s: since the session began
  load,         // static load of the joint: force and moment in its axis frame
  tip_load  // the same at the link's end, without the link's own weight; span, weight, own_moment
};
std::string to_string(Covariate covariate);

// A small motion: translation (mm), then rotation vector (rad).
template <class T>
struct Twist {
  Vector3<T> translation{}, rotation{};
};

// What is known at the place where an effect acts. Only what the declaration needs is filled in.
// Forces in mN (kg mm/s^2), moments in uN m (kg mm^2/s^2).
template <class T>
struct Around {
  T reading{};     // raw, of the sensor that is corrected
  T coordinate{};  // of the joint, without corrections of coordinates
  T driver{};      // coordinate named by the attribute `driver`
  T approach{}, time{}, session{}, pose{}, temperature{}, rate{}, travel{}, since{};
  Vector3<T> force{}, moment{};                            // on the joint, axis frame
  Vector3<T> tip_force{}, tip_moment{}, weight{}, span{};  // on the link's end, its own frame
  Vector3<T> own_moment{};                                 // of the link's weight, about that end
  Vector3<T> position{};                                   // modelled, of the measured feature
};

enum class Role {
  plain,
  amount,   // zero where nothing is wrong
  setting,  // a number that shapes the effect; a diagnosis tries some values
  borrowed  // the input of the same name of the sensor
};

enum class Driven { no, by_other, by_own, by_any };  // by which coordinate, seen from the joint

// Amounts that a diagnosis tries together, and with which drivers.
struct EffectForm {
  std::vector<std::string> amounts;
  Driven driven = Driven::no;  // no: as the effect says
  bool finer = false;          // only tried in the place of a coarser one that was found
};

// How results show amounts: as they are, or two or three of them together.
struct Figure {
  enum class Kind { phasor, vector, ellipse, scaled } kind = Kind::vector;
  std::string name, second;          // magnitude, and angle of two amounts
  std::vector<std::string> amounts;  // phasor: sine, cosine; vector: components; ellipse:
                                     // sine and cosine along x, along y
  std::string unit;                  // of `name`, where not that of the amounts
};
inline Figure phasor(std::string amplitude, std::string phase, std::string sine,
                     std::string cosine) {
  return {Figure::Kind::phasor,
          std::move(amplitude),
          std::move(phase),
          {std::move(sine), std::move(cosine)},
          ""};
}
inline Figure magnitude(std::string name, std::string direction, std::vector<std::string> of) {
  return {Figure::Kind::vector, std::move(name), std::move(direction), std::move(of), ""};
}
inline Figure renamed(std::string amount, std::string name, std::string unit = "") {
  return {Figure::Kind::scaled, std::move(name), "", {std::move(amount)}, std::move(unit)};
}

// Amplitude, phase and direction of a motion to and fro: sine and cosine along x, along y.
inline Figure ellipse(std::vector<std::string> amounts) {
  return {Figure::Kind::ellipse, "amplitude", "phase", std::move(amounts), ""};
}

struct EffectTraits {
  Acts acts = Acts::reading;
  std::vector<Covariate> needs;
  std::string onset;  // name of the setting from which on it acts
  Covariate onset_of = Covariate::pose;
  std::vector<Dimension> on;  // empty: any
  Driven driven = Driven::no;
  std::string driver_meaning;
  std::vector<EffectForm> forms;  // empty: all amounts together
  std::vector<Figure> figures;
  std::string same_as, reference;
  bool everywhere = false;
  bool unknown = false;   // a curve of no known cause
  bool at_joint = false;  // corrects a reading, but is called by the joint where that is an angle
  // Usual size of the correction itself (mm, rad), where that is better known than the amounts';
  // their typical values are then the largest plausible ones.
  double typical_length = 0, typical_angle = 0;
};

}  // namespace talus
