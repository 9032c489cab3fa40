#include "framework/registry/bind.h"

namespace talus {
namespace {

// Hinge between two bones whose axis is orthogonal to neither: offsets from the proximal limb (fp)
// and to the distal limb (td) on both sides of the rotation, psi about x, phi about y, theta about
// z. T_A_B = Trans_fp Rx(psi_fp) Ry(phi_fp) Rz(theta_fp) Rz(theta)
//         Rz(theta_td) Ry(phi_td) Rx(psi_td) Trans_td          (Storey 2006, sec. III and IV)
struct Storey {
  static Declaration declaration() {
    return joint("storey",
                 "hinge of non-orthogonal limbs: Trans Rx Ry Rz (fp) Rz(theta) Rz Ry Rx Trans (td) "
                 "(Storey 2006, sec. III)")
        .coordinate("theta", angle, "rotation about the joint's z axis")
        .input("x_fp", length, 0, "x of the joint's centre in the proximal limb")
        .input("y_fp", length, 0, "y of it")
        .input("z_fp", length, 0, "z of it")
        .input("psi_fp", angle, 0, "roll from the proximal limb, about x")
        .input("phi_fp", angle, 0, "yaw from the proximal limb, about y")
        .input("theta_fp", angle, 0, "pitch from the proximal limb, about z")
        .input("theta_td", angle, 0, "pitch to the distal limb, about z")
        .input("phi_td", angle, 0, "yaw to the distal limb, about y")
        .input("psi_td", angle, 0, "roll to the distal limb, about x")
        .input("x_td", length, 0, "x of the distal limb's centre, seen from the joint")
        .input("y_td", length, 0, "y of it")
        .input("z_td", length, 0, "z of it");
  }
  template <class T>
  static Rigid<T> transform(T theta, T x_fp, T y_fp, T z_fp, T psi_fp, T phi_fp, T theta_fp,
                            T theta_td, T phi_td, T psi_td, T x_td, T y_td, T z_td) {
    return translate(x_fp, y_fp, z_fp) * rotate_x(psi_fp) * rotate_y(phi_fp) * rotate_z(theta_fp) *
           rotate_z(theta) * rotate_z(theta_td) * rotate_y(phi_td) * rotate_x(psi_td) *
           translate(x_td, y_td, z_td);
  }
};
TALUS_PLUGIN(Storey)

}  // namespace
}  // namespace talus
