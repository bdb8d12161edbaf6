#include "taxelsim/model.h"

#include "simulation/model_access.h"
#include "simulation/model_impl.h"
#include "simulation/small_objects.h"

namespace taxelsim {

Model::Impl::Impl(const Device& device, const ModelOptions& options, const Tuning& tuning)
    : data(device, options),
      tiles(data, options, tuning),
      contact(data, tiles),
      candidates(data, tiles),
      taxel_laws(data),
      image(data, options, tuning),
      three_axis(data),
      load_search(data, image.sizes().pass.workgroup),
      contacts(data, image),
      contact_features(data, options),
      tactile_jacobian(data, options),
      integer_features(data),
      servo(data),
      place(data) {
  if (data.hasMask()) deformation_mask.emplace(data, options);
  if (data.layer) heights.emplace(data, tiles);
  if (data.layer) elastic_layer.emplace(data, options);
}

Model::Model(const Device& device, const ModelOptions& options) : impl_(std::make_shared<Impl>(device, options, Tuning{})) {
  warnOfSmallObjects(sensor(), objects());
}

Model ModelAccess::make(const Device& device, const ModelOptions& options, const Tuning& tuning) {
  return Model(std::make_shared<Model::Impl>(device, options, tuning));
}

const Sensor& Model::sensor() const {
  return impl_->data.sensor;
}
const std::vector<Object>& Model::objects() const {
  return impl_->data.objects;
}
const Device& Model::device() const {
  return impl_->data.device;
}

}  // namespace taxelsim
