#include "framework/registry/bind.h"

namespace talus {
namespace {

// All lengths of the joints' transforms grow with the recorded temperature; steel 11.5e-6,
// aluminium 23e-6, printed plastic 70e-6 to 90e-6 per degree (ISO 1: lengths are meant at 20 degC).
struct ThermalExpansion {
  static Declaration declaration() {
    return effect("thermal_expansion", Acts::lengths,
                  "links lengthen with the temperature: coefficient (T - reference)")
        .amount("coefficient", number / temperature, 2e-5, "relative lengthening per degree")
        .setting("reference", temperature, 20, {}, "temperature at which lengths are as given")
        .needs(Covariate::temperature)
        .everywhere()
        .reference("ISO 1, ISO 230-3");
  }
  template <class T>
  static T act(const Around<T>& around, T coefficient, T reference) {
    return coefficient * (around.temperature - reference);
  }
};
TALUS_PLUGIN(ThermalExpansion)

}  // namespace
}  // namespace talus
