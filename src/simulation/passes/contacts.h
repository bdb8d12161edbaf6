// Contacts pass, shaders/contacts.comp: stages 1 and 2 from contact points and forces of another engine, in place of the contact pass.
#pragma once

#include "simulation/model_data.h"
#include "simulation/passes/image.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"

namespace taxelsim {

class ContactsPass {
 public:
  // Workgroups and teams are those of the image pass.
  ContactsPass(const ModelData& model, const ImagePass& image) : model_(model), image_(image) {}

  // `max_contacts`: of an instance.
  void record(Recorder& recorder, int max_contacts) const;

 private:
  using Kernel = gpu::PassKernel<ContactsInterface>;
  Kernel makeKernel(std::uint32_t repeat) const;

  const ModelData& model_;
  const ImagePass& image_;
  KernelCache<std::uint32_t, Kernel> kernels_;  // by instances that a team does in sequence
};

}  // namespace taxelsim
