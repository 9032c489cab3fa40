#include "tests/engine/mjcf.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <sstream>

namespace engine {
namespace {

constexpr double deg = std::numbers::pi / 180, mm = 1e-3;
using Kind = Flaw::Kind;

class Writer {
 public:
  explicit Writer(const Linkage& l) : l_(l) { out_.precision(17); }

  std::string text() {
    out_ << "<mujoco><compiler angle=\"radian\" boundmass=\"1e-7\" boundinertia=\"1e-10\"/>\n"
            "<option timestep=\"0.0005\" jacobian=\"dense\" integrator=\"Euler\" tolerance=\"0\" "
            "iterations=\"200\"><flag contact=\"disable\"/></option>\n<worldbody>\n"
            "<body name=\"holder\" mocap=\"true\"/>\n";
    mount(l_.base, "base");
    for (int i = 1; i <= 6; ++i) joint(i);
    mount(l_.end, "end");
    open("payload");
    out_ << "<inertial pos=\"0 0 0\" mass=\"1e-7\" diaginertia=\"1e-9 1e-9 1e-9\"/>\n";
    for (; depth_ > 0; --depth_) out_ << "</body>\n";
    out_ << "</worldbody>\n";
    if (!strings_.empty()) out_ << "<tendon>" << strings_ << "</tendon>\n";
    if (l_.held)
      out_ << "<equality><weld body1=\"end\" body2=\"holder\" relpose=\"0 0 0 1 0 0 0\" "
              "solref=\"0.004 1\"/></equality>\n";
    out_ << "</mujoco>\n";
    return out_.str();
  }

 private:
  void open(const std::string& name, const Eigen::Vector3d& at = {0, 0, 0}, char axis = 0,
            double turn = 0) {
    out_ << "<body";
    if (!name.empty()) out_ << " name=\"" << name << '"';
    out_ << " pos=\"" << at.transpose() << '"';
    if (axis)
      out_ << " axisangle=\"" << (axis == 'x') << ' ' << (axis == 'y') << ' ' << (axis == 'z')
           << ' ' << turn << '"';
    out_ << ">\n";
    ++depth_;
  }

  void mount(const Mount& m, const std::string& name) {
    open("", {m.shift[0].value * mm, m.shift[1].value * mm, m.shift[2].value * mm});
    for (int i = 0; i < 3; ++i)
      open(i < 2 ? "" : name, {0, 0, 0}, m.axes[static_cast<std::size_t>(i)],
           m.turns[i].value * deg);
  }

  void hinge(const std::string& name, const Eigen::Vector3d& axis, double stiffness,
             const std::string& more = "", const std::string& type = "hinge") {
    out_ << "<joint name=\"" << name << "\" type=\"" << type << "\" axis=\"" << axis.transpose()
         << "\" stiffness=\"" << stiffness << "\" " << more << "/>\n";
  }

  // Compliance in deg/(N m). Damped so that what an arm's inertia (some kg m^2) swings soon rests.
  void spring(const std::string& name, const Eigen::Vector3d& axis, double compliance) {
    const double stiffness = 1 / (compliance * deg);
    hinge(name, axis, stiffness, "damping=\"" + std::to_string(2 * std::sqrt(3 * stiffness)) + '"');
  }

  void joint(int i) {
    const std::string n = std::to_string(i);
    open("stator" + n);
    if (const Flaw* f = l_.flaw(Kind::tilting, i)) {
      spring("tilt_x" + n, {1, 0, 0}, f->size);
      spring("tilt_y" + n, {0, 1, 0}, f->size);
    }
    if (const Flaw* f = l_.flaw(Kind::clearance, i)) {
      out_ << "<site name=\"hole" << n << "\"/>\n";
      open("pin" + n);
      hinge("loose_x" + n, {1, 0, 0}, 0, "damping=\"20\"", "slide");
      hinge("loose_y" + n, {0, 1, 0}, 0, "damping=\"20\"", "slide");
      out_ << "<site name=\"centre" << n << "\"/>\n";
      std::ostringstream string;
      string << "<spatial limited=\"true\" range=\"0 " << f->size * mm
             << "\" solreflimit=\"0.002 1\" solimplimit=\"0.999 0.999 0.001\"><site site=\"hole"
             << n << "\"/><site site=\"centre" << n << "\"/></spatial>";
      strings_ += string.str();
    }
    out_ << "<site name=\"head" << n << "\" pos=\"" << head_radius << " 0 0\"/>\n";
    open("motor" + n);
    const Flaw* dragged = l_.flaw(Kind::play_approach, i);
    if (l_.held) hinge("hinge" + n, {0, 0, 1}, 0, "damping=\"0.5\"");
    const Flaw* eccentric = l_.flaw(Kind::eccentric, i);
    const double e = eccentric ? eccentric->size * head_radius : 0,
                 phase = eccentric ? eccentric->extra * deg : 0;
    out_ << "<site name=\"disc" << n << "\" pos=\"" << e * std::cos(phase) << ' '
         << e * std::sin(phase) << " 0\"/>\n";
    if (dragged) {  // stops on the motor's shaft, brake on the link: hinged to the stator
      out_ << "</body>\n";
      --depth_;
    }
    open("rotor" + n);
    if (const Flaw* f = l_.flaw(Kind::elastic, i)) spring("spring" + n, {0, 0, 1}, f->size);
    const std::string stiff = "solreflimit=\"0.002 1\" solimplimit=\"0.9999 0.9999 0.001\" ";
    if (const Flaw* f = l_.flaw(Kind::play_load, i)) {
      std::ostringstream range;
      range << stiff << "damping=\"20\" limited=\"true\" range=\"" << -f->size * deg << ' '
            << f->size * deg << '"';
      hinge("play" + n, {0, 0, 1}, 0, range.str());
    }
    if (dragged)
      hinge("drag" + n, {0, 0, 1}, 0,
            stiff +
                "damping=\"1\" frictionloss=\"15\" solimpfriction=\"0.9999 0.9999 0.001\" "
                "limited=\"true\" range=\"-1 1\"");
    link(i);
  }

  void mass(double m, const Eigen::Vector3d& at) {
    const double inertia = m * 0.05 * 0.05;
    out_ << "<inertial pos=\"" << at.transpose() << "\" mass=\"" << m << "\" diaginertia=\""
         << inertia << ' ' << inertia << ' ' << inertia << "\"/>\n";
  }

  void link(int i) {
    const std::string n = std::to_string(i);
    const Link& k = l_.links[static_cast<std::size_t>(i - 1)];
    const Eigen::Vector3d span(k.a.value * mm, 0, k.d.value * mm),
        com(k.com[0] * mm, k.com[1] * mm, k.com[2] * mm);
    const Flaw* bends = l_.flaw(Kind::bending, i);
    // Behind the joint; the link's own end is turned against it.
    const Eigen::Matrix3d turned(Eigen::AngleAxisd(k.alpha.value * deg, Eigen::Vector3d::UnitX()) *
                                 Eigen::AngleAxisd(k.beta.value * deg, Eigen::Vector3d::UnitY()));
    const double along = (span + turned * com).dot(span) / span.squaredNorm();
    if (bends) {
      // Weight spread evenly, as far beside the line as its centre is; or all of it on the end,
      // where the centre does not lie between the ends.
      const bool spread = along > 0 && along < 1;
      const Eigen::Vector3d beside = span / 2 + turned * com, piece = span / pieces;
      const Eigen::Vector3d one = span.cross(Eigen::Vector3d::UnitY()).normalized(),
                            other = span.cross(one).normalized();
      const double k1 = 1 / (bends->size * piece.norm()),
                   k2 = k1 * (bends->extra > 0 ? bends->extra : 1);
      const double share = spread ? k.mass / pieces : 1e-6;
      mass(share / 2, piece / 4 + beside);
      for (int p = 0; p < pieces; ++p) {
        open("", p == 0 ? Eigen::Vector3d(piece / 2) : piece);
        hinge("bend" + n + "_" + std::to_string(p), one, k1, "damping=\"1\"");
        hinge("bend" + n + "_" + std::to_string(p) + "b", other, k2, "damping=\"1\"");
        const bool last = p == pieces - 1;
        mass(share / (last ? 2 : 1), piece / (last ? 4 : 2) + beside);
      }
      open("", piece / 2, 'x', k.alpha.value * deg);
      open("link" + n, {0, 0, 0}, 'y', k.beta.value * deg);
      if (!spread) mass(k.mass, com);
    } else {
      open("", span, 'x', k.alpha.value * deg);
      open("link" + n, {0, 0, 0}, 'y', k.beta.value * deg);
      mass(k.mass, com);
    }
  }

  const Linkage& l_;
  std::ostringstream out_;
  std::string strings_;
  int depth_ = 0;
};

}  // namespace

std::string mjcf(const Linkage& linkage) { return Writer(linkage).text(); }

}  // namespace engine
